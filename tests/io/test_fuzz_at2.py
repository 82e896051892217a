"""Whatever the bytes: the AT2 reader gives finite values as many as announced, or refuses with RecordError."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rockcli.errors import RecordError
from rockcli.motion.at2 import AT2, is_at2, looks_like_at2, parse_at2
from rockcli.motion.reading import read_record

HEADER = (
    "PEER NGA STRONG MOTION DATABASE RECORD\nEvent, 1/2/2003, Station, 090\nACCELERATION TIME SERIES IN UNITS OF G\n"
)
COUNT = "NPTS=     12, DT=   .0050 SEC,   0 POLE @    30.00000 HZ\n"
ROW = "   .1181069E-02   .1366453E-02   .9006674E-03  -.6490293E-04\n"
VALID = (HEADER + COUNT + 3 * ROW).encode()

PIECES = st.sampled_from(
    [
        *(bytes([byte]) for byte in b"\n\r\t -+_.,=#(*ED09\0\xff"),
        *(b"", b"nan", b"inf", b"1e999", b"1.0-100", b"NPTS", b"DT", b"UNITS OF G", b"NPTS= 3, DT= .1"),
    ]
)
MUTATION = st.tuples(st.integers(0, len(VALID)), st.integers(0, 12), PIECES)


def parsed(data: bytes) -> AT2 | None:
    """What the reader makes of the bytes, its promises kept; None if it refuses."""
    refusal = None
    try:
        record = parse_at2(data, "fuzz.AT2")
    except RecordError as error:
        refusal = str(error)
    if refusal is not None:
        assert refusal.startswith("fuzz.AT2")
        return None
    assert record.values.dtype == np.float64
    assert record.values.ndim == 1
    assert len(record.values) >= 2
    assert np.isfinite(record.values).all()
    assert 0.0 < record.dt < np.inf
    assert looks_like_at2(data)
    return record


@settings(max_examples=300, deadline=None)
@given(st.binary(max_size=400))
def test_any_bytes(data: bytes) -> None:
    parsed(data)
    parsed((HEADER + COUNT).encode() + data)


@settings(max_examples=1200, deadline=None)
@given(st.lists(MUTATION, min_size=1, max_size=4))
def test_mutations_of_a_valid_file(mutations: list[tuple[int, int, bytes]]) -> None:
    data = VALID
    for place, removed, piece in mutations:
        data = data[:place] + piece + data[place + removed :]
    parsed(data)


def test_no_file_cut_short_is_read() -> None:
    assert [end for end in range(len(VALID) - 1) if parsed(VALID[:end]) is not None] == []


@settings(max_examples=200, deadline=None)
@given(
    st.lists(st.floats(-9.0, 9.0, allow_nan=False).map(lambda x: float(f"{x:.7e}")), min_size=2, max_size=40),
    st.integers(1, 9),
    st.sampled_from(["\n", "\r\n", "\r\r\n"]),
    st.sampled_from(["E", "D", "e"]),
)
def test_what_is_printed_is_read(values: list[float], per_line: int, end: str, letter: str) -> None:
    words = [f"{value:16.7E}".replace("E", letter) for value in values]
    rows = ["".join(words[i : i + per_line]) for i in range(0, len(words), per_line)]
    text = HEADER + f"NPTS= {len(values)}, DT= .01 SEC\n" + "\n".join(rows) + "\n"
    record = parsed(text.replace("\n", end).encode())
    assert record is not None
    assert record.values.tolist() == values


@pytest.mark.slow
@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(max_size=300) | st.text("0123.-+eEdD,\n #", max_size=40).map(str.encode))
def test_any_file(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "fuzz"
    path.write_bytes(data)
    assert is_at2(path) in (True, False)
    try:
        motion = read_record(path, units="g", dt=0.01)
    except RecordError:
        return
    assert np.isfinite(motion.values).all()
