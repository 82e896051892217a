"""Which path of the study a coordinate of a dataset is, by its attributes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def axis_path(attrs: Mapping[str, Any], name: str) -> str:
    """Path inside the case of the coordinate `name`; datasets without `path`, of earlier builds, have it as long_name.

    Of what is no coordinate of the study: its long_name, or `name` without one.
    """
    return str(attrs.get("path", attrs.get("long_name", name)))
