"""Small AT2 files as text, and the shared folder of real records where there is one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

SHARED = Path(__file__).parents[3] / "shared" / "records"


@pytest.fixture(scope="session")
def shared_records() -> Path:
    if not SHARED.is_dir():
        pytest.skip("the shared folder of real records is not beside the repository")
    return SHARED


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    """Write bytes or text under a name, without translating line ends."""

    def write(content: str | bytes, name: str = "record.AT2") -> Path:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return write
