"""Numbers parsed by the compiled kernel: the bits of `float`, whatever is printed; all else is left to the reader of words.

Skipped where kernels are not compiled ahead of time, as nothing is compiled for the sake of reading.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockcli import kernels
from rockcli.errors import RecordError
from rockcli.motion import numbers
from rockcli.motion.measures import pgv
from rockcli.motion.numbers import Numbers, read_text
from rockcli.motion.reading import SEVERAL, read_record, ready_for

pytestmark = pytest.mark.skipif(not kernels.compiled_ahead(), reason="no kernels compiled ahead of time")

SHIPPED = Path(__file__).resolve().parents[2] / "records"
FOLDERS = [SHIPPED, *(Path(entry) for entry in os.environ.get("ROCK_RECORDS", "").split(os.pathsep) if entry)]


@pytest.fixture(autouse=True, scope="module")
def _loaded() -> None:
    ready_for(SEVERAL)


def without_kernels(read: Callable[[], Any]) -> Any:
    """What a reader makes without compiled kernels, its error as text."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kernels, "in_use_ahead", lambda name: None)
        return outcome(read)


def outcome(read: Callable[[], Any]) -> Any:
    try:
        found = read()
    except RecordError as error:
        return type(error), str(error)
    if isinstance(found, Numbers):
        return found.values.tobytes(), found.per_line.tolist(), found.last, found.shortest, found.text_after
    told = {name: value for name, value in vars(found).items() if name != "values"}
    return found.values.dtype, found.values.tobytes(), told


def parsed(text: bytes, room: int | None = None) -> np.ndarray | None:
    return numbers._parsed(text, room)


def same(text: bytes, room: int | None = None) -> None:
    def read() -> Numbers:
        return read_text(text, 1, "file", room)

    assert outcome(read) == without_kernels(read)


FORMATS = {
    "C": "{:15.7E}", "long": "{:20.12E}", "short": "{:9.1e}", "three digits": "{:16.7E}", "fixed": "{:9.5f}",
    "fifteen digits": "{:24.14e}", "signs": "{:+12.4E}", "narrow": "{:8.3f}",
}  # fmt: skip


@pytest.mark.parametrize("kind", [*FORMATS, "FORTRAN"])
@pytest.mark.parametrize("end", ["\n", "\r\n", " \n", "\n\n\t"])
def test_numbers_in_columns_are_parsed_by_the_kernel_to_the_bits_of_float(kind: str, end: str) -> None:
    rng = np.random.default_rng(len(end))
    values = rng.normal(size=203) * 10.0 ** rng.integers(-4, 3, 203)
    values[1] = -0.0
    if kind == "FORTRAN":  # as 5E15.7 prints: no digit before the point
        printed = [f"{('-' if x < 0 else '') + '.' + f'{abs(x):.6E}'.replace('.', ''):>15}" for x in values]
    else:
        printed = [FORMATS[kind].format(x) for x in values]
    text = "".join(" ".join(printed[i : i + 5]) + end for i in range(0, 203, 5)).encode() + b"\n"
    found = parsed(text)
    assert found is not None
    assert found.tobytes() == np.array([float(word) for word in printed]).tobytes()
    assert found.tobytes() == read_text(text, 1, "file").values.tobytes()


DIGITS = st.text("0123456789", min_size=1, max_size=24)
EXPONENTS = st.one_of(
    st.just(""),
    st.builds(
        "{}{}{:0{}d}".format,
        st.sampled_from("eEdD"),
        st.sampled_from(["", "+", "-"]),
        st.integers(0, 400),
        st.integers(1, 6),
    ),
)
WORDS = st.one_of(
    st.builds("{}{}.{}{}".format, st.sampled_from(["", "-", "+"]), DIGITS, DIGITS, EXPONENTS),
    st.builds("{}{}{}".format, st.sampled_from(["", "-"]), DIGITS, EXPONENTS),
    st.builds("{}.{}{}".format, st.sampled_from(["", "-"]), DIGITS, EXPONENTS),
    st.floats(allow_nan=False, allow_infinity=False).map(repr),
    st.floats(-1e3, 1e3).map("{:15.7E}".format),
    st.sampled_from(["9007199254740992", "9007199254740993", "1e22", "1e23", "1e-22", "1e-23", "4.9e-324", "1e309", "0e999", "-0", "007.5"]),
)  # fmt: skip
BETWEEN = st.sampled_from([" ", "  ", "\n", "\r\n", "\t", "\n\n", " \r\n "])
ODD = st.sampled_from(
    [
        "-",
        "+",
        ".",
        "e",
        "1-2",
        "1.5-103",
        "--1",
        "1e",
        "1e+",
        "+ 1",
        "1.2.3",
        "nan",
        "inf",
        "\x0b",
        "\r",
        "\0",
        "1_0",
        "x",
        "\xb2",
        ",",
        "1,2",
        "/",
        ":",
        "end",
    ]
)


@settings(max_examples=400, deadline=None)
@given(
    st.lists(st.tuples(WORDS, BETWEEN), max_size=12),
    st.sampled_from(["\n", "", " \n"]),
    st.one_of(st.none(), st.integers(1, 14)),
)
def test_whatever_is_printed_has_the_bits_of_float(words: list[tuple[str, str]], end: str, room: int | None) -> None:
    same(("".join(word + blank for word, blank in words) + end).encode(), room)


@settings(max_examples=400, deadline=None)
@given(st.lists(st.tuples(st.one_of(WORDS, ODD), BETWEEN), max_size=8), st.one_of(st.none(), st.integers(1, 9)))
def test_what_is_no_plain_number_is_told_as_without_the_kernel(words: list[tuple[str, str]], room: int | None) -> None:
    same(("".join(word + blank for word, blank in words) + "\n").encode("latin-1"), room)


@settings(max_examples=300, deadline=None)
@given(st.text("0123456789.eE+- \n\r\tdD", max_size=30))
def test_any_characters_of_numbers(text: str) -> None:
    same((text + "\n").encode())


def test_exponents_and_digits_beyond_the_exact_ones_are_left_to_float() -> None:
    exact = [b"9007199254740992\n", b"1e22\n", b"123456789012345e-22\n", b"0.000000000000001\n"]
    left = [b"9007199254740993\n", b"1e23\n", b"1e-23\n", b"1.234567890123456789\n", b"1e00022\n"]
    assert all(parsed(text) is not None for text in exact)
    assert all(parsed(text) is None for text in left)
    assert parsed(b"1 2 3\n", 2) is None  # more than are expected


FILES = sorted({path for folder in FOLDERS for path in folder.rglob("*") if path.is_file()})


@pytest.mark.parametrize("told", [{}, {"units": "g"}, {"units": "g", "dt": 0.005}])
def test_every_record_is_read_as_without_the_kernel(told: dict[str, Any]) -> None:
    assert FILES
    for path in FILES:
        assert outcome(lambda: read_record(path, **told)) == without_kernels(lambda: read_record(path, **told)), path


@pytest.mark.parametrize("n", [2, 3, 50, 4001])
def test_the_peak_velocity_has_the_bits_of_numpy(n: int) -> None:
    rng = np.random.default_rng(n)
    for a in (rng.normal(size=n), np.zeros(n), rng.normal(size=2 * n)[::2], np.round(rng.normal(size=n), 1)):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(kernels, "in_use_ahead", lambda name: None)
            wanted = pgv(a, 0.01)
        assert pgv(a, 0.01) == wanted
