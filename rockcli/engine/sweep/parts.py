"""Finished chunks of a sweep, kept in the result folder until the dataset is written."""

from __future__ import annotations

import contextlib
import hashlib
import shutil
from collections.abc import Iterator
from pathlib import Path
from time import monotonic
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.sweep.chunk_result import ChunkResult, cases_of, spans_of
from rockcli.storage.atomic import sweep_leftovers, write_text
from rockcli.storage.part import read_part, write_part
from rockcli.study.study import Study

FOLDER = ".parts"

_ANEW = "fresh"
"""Beside the parts of a run that replaces what stands there, so that the next one goes on with it."""

EVERY = 5.0
"""Time between two parts [s]; what took less and was not written is solved again."""

MOST = 1 << 22
"""Cases that wait at most to be written."""

_KINDS = ("scalars", "histories", "impacts", "shaken")

_FORMAT = 3
"""Of parts; those of another are passed over and their cases solved again."""


class Keeper(Protocol):
    """Where finished answers are kept; `damaged`: parts met that cannot be read."""

    damaged: int

    def kept(self) -> Iterator[ChunkResult]:
        """Answers of earlier runs."""
        ...

    def keep(self, answer: ChunkResult) -> None:
        """Keep an answer, sooner or later."""
        ...


class Parts:
    """The parts of one study in its result folder, in a folder named by the study's identity.

    A part holds the answers that came within some seconds, and is named by the cases it holds.
    """

    def __init__(self, results: Path, study: Study) -> None:
        self.all = results / FOLDER
        self.folder = self.all / study.identity[:16]
        self.identity = study.identity
        self.damaged = 0
        self._waiting: list[ChunkResult] = []
        self._cases = 0
        self._since = monotonic()

    def kept(self) -> Iterator[ChunkResult]:
        """Answers of earlier runs and of other shares; what is damaged, of another study or format is passed over."""
        for path in sorted(self.folder.glob("[!.]*.npz")):
            found = read_part(path)
            if found is None:
                self.damaged += 1
            elif (found[1].get("identity"), found[1].get("format")) == (self.identity, _FORMAT):
                yield from _unpacked(*found)

    def keep(self, answer: ChunkResult) -> None:
        """Keep an answer; it is written with others every few seconds."""
        self._waiting.append(answer)
        self._cases += len(answer.cases)
        if monotonic() - self._since > EVERY or self._cases > MOST:
            self.flush()

    def flush(self) -> None:
        """Write what waits.

        Raises:
            OutputError: it cannot be written.
        """
        if self._waiting:
            arrays, words = _packed(self._waiting)
            spans = np.concatenate([arrays[f"{i}.spans"].ravel() for i in range(len(self._waiting))])
            name = f"{spans[0]:012d}-{hashlib.sha256(spans.tobytes()).hexdigest()[:16]}"
            try:
                write_part(self.folder / f"{name}.npz", arrays, words | {"identity": self.identity, "format": _FORMAT})
            except BaseException:
                self._tidy()
                raise
            self._waiting = []
        self._cases = 0
        self._since = monotonic()

    @property
    def anew(self) -> bool:
        """Whether a run of this study that was to replace what stands in the folder was broken off."""
        return (self.folder / _ANEW).exists()

    def begin_anew(self) -> None:
        """Forget the parts of whatever study, and keep in mind that what stands in the folder is to be replaced.

        Raises:
            OutputError: the folder cannot be written in.
        """
        self.remove(of_others=True)
        write_text(self.folder / _ANEW, "")

    def sweep(self) -> None:
        """Remove scratch files of killed runs; only for who holds the folder alone."""
        if self.folder.is_dir():
            sweep_leftovers(self.folder)

    def remove(self, *, of_others: bool = False) -> None:
        """Remove the parts of this study, or of whatever study; only for who holds the folder alone."""
        shutil.rmtree(self.all if of_others else self.folder, ignore_errors=True)
        self._tidy()
        self._waiting = []

    def _tidy(self) -> None:
        """Remove folders in which nothing is left."""
        with contextlib.suppress(OSError):
            self.folder.rmdir()
        with contextlib.suppress(OSError):
            self.all.rmdir()


def _packed(answers: list[ChunkResult]) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    arrays: dict[str, NDArray[Any]] = {}
    words: list[dict[str, Any]] = []
    for i, answer in enumerate(answers):
        arrays[f"{i}.spans"] = spans_of(answer.cases)
        arrays[f"{i}.time"] = answer.time
        for kind in _KINDS:
            arrays |= {f"{i}.{kind}.{name}": values for name, values in getattr(answer, kind).items()}
        for j, where in enumerate(answer.sentences.values()):
            arrays[f"{i}.said.{j}"] = where
        words.append({"said": list(answer.sentences), "used": answer.used})
    return arrays, {"answers": words}


def _unpacked(arrays: dict[str, NDArray[Any]], words: dict[str, Any]) -> Iterator[ChunkResult]:
    for i, told in enumerate(words["answers"]):
        answer = ChunkResult(cases_of(arrays[f"{i}.spans"]), {}, time=arrays[f"{i}.time"])
        answer.used = [(int(first), dict(one)) for first, one in told["used"]]
        answer.sentences = {sentence: arrays[f"{i}.said.{j}"] for j, sentence in enumerate(told["said"])}
        for name, values in arrays.items():
            number, kind, *rest = name.split(".")
            if number == str(i) and kind in _KINDS:
                getattr(answer, kind)[".".join(rest)] = values
        yield answer
