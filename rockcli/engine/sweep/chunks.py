"""Chunks of a sweep: which cases are left, and how many are solved at a time."""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

from rockcli.study.study import Index

_WINDOW = 1 << 20
"""Cases looked through at a time for those that are left."""

CHUNK = 16384
"""Cases solved at a time, at most: what is known of four times as many no longer fits the caches (a twelfth slower)."""

FIRST, TARGET = 0.2, 1.0
"""Time that the first chunk, where something is to be learned from it, and the others are meant to take [s]."""

REST = 1.25
"""A chunk is up to so many times as large as it should be if it is the last then: few cases cost more each."""

LEAST = 0.03
"""Time of the chunks near the end, a fourth of it of the last [s]: one costs 3 ms beside its cases."""

SHARES = 4
"""Chunks that are left for every worker near the end, so that none waits long for the last."""


Spans = list[tuple[int, int]]
"""First and last + 1 of each."""

Turned = tuple[tuple[int, ...], int]
"""Points of every axis, and the axis along which cases are handed out last."""


def counted(spans: Spans) -> int:
    """How many numbers there are in spans."""
    return sum(stop - first for first, stop in spans)


def without(spans: Spans, others: Spans) -> Spans:
    """What of some spans is not in others; both ascending, and so is the result."""
    left: Spans = []
    at = 0
    for first, stop in spans:
        while at < len(others) and others[at][1] <= first:
            at += 1
        k = at
        while k < len(others) and others[k][0] < stop:
            if others[k][0] > first:
                left.append((first, others[k][0]))
            first = max(first, others[k][1])
            k += 1
        if first < stop:
            left.append((first, stop))
    return left


def places_in_turn(cases: Index, turned: Turned | None) -> Index:
    """Where cases stand in the order in which `Chunks` hands them out, ascending."""
    if turned is None:
        return cases
    shape, axis = turned
    others = list(np.unravel_index(cases, shape))
    point = others.pop(axis)
    return np.sort(np.ravel_multi_index((point, *others), (shape[axis], *shape[:axis], *shape[axis + 1 :])))


class Chunks:
    """Hands out the cases that are left, in order; what was lost comes back and goes first.

    Args:
        size: cases in all.
        todo: which of them are left, (size,), or spans of places in the order in which they are handed out, ascending;
            None = all.
        turned: points of every axis, and the axis along which to go last: what its points have in common with all
            others is then found for few chunks.  None = in the order of the cases.
    """

    def __init__(self, size: int, todo: NDArray[np.bool_] | Spans | None = None, turned: Turned | None = None) -> None:
        self.size = size
        self._turned = turned
        spans = [(0, size)] if todo is None else todo
        self._spans = deque(spans) if isinstance(spans, list) else None
        if not isinstance(todo, list) and todo is not None and turned is not None:
            todo = np.ascontiguousarray(np.moveaxis(todo.reshape(turned[0]), turned[1], 0)).ravel()
        self._todo = None if isinstance(todo, list) else todo
        self.left = counted(spans) if isinstance(spans, list) else int(spans.sum())
        self._next = 0
        self._returned: list[Index] = []

    @classmethod
    def of(cls, cases: Index) -> Chunks:
        """Those of some cases, ascending."""
        chunks = cls(0)
        chunks.give_back(cases)
        return chunks

    def take(self, most: int) -> Index:
        """The next cases, ascending, `most` at the most; empty when there are none."""
        if self._returned:
            cases = self._returned.pop()
            if len(cases) > most:
                self._returned.append(cases[most:])
                cases = cases[:most]
        elif self._spans is not None:
            cases = self._cases_at(self._from_spans(most))
        else:
            cases = self._cases_at(self._search(most))
        self.left -= len(cases)
        return cases

    def _cases_at(self, places: Index) -> Index:
        """The cases at places, ascending, in the order they are handed out in."""
        if self._turned is None:
            return places
        shape, axis = self._turned
        point, *others = np.unravel_index(places, (shape[axis], *shape[:axis], *shape[axis + 1 :]))
        others.insert(axis, point)
        return np.sort(np.ravel_multi_index(tuple(others), shape).astype(np.int64))

    def _from_spans(self, most: int) -> Index:
        assert self._spans is not None
        found = [np.empty(0, dtype=np.int64)]
        while most and self._spans:
            first, stop = self._spans.popleft()
            if stop - first > most:
                self._spans.appendleft((first + most, stop))
                stop = first + most
            found.append(np.arange(first, stop))
            most -= stop - first
        return np.concatenate(found)

    def _search(self, most: int) -> Index:
        assert self._todo is not None
        found: list[Index] = []
        missing = most
        while missing and self._next < self.size:
            rows = np.flatnonzero(self._todo[self._next : self._next + max(_WINDOW, most)])[:missing] + self._next
            full = len(rows) == missing
            self._next = int(rows[-1]) + 1 if full else self._next + max(_WINDOW, most)
            missing -= len(rows)
            found.append(rows)
        return np.concatenate(found) if found else np.empty(0, dtype=np.int64)

    def give_back(self, cases: Index) -> None:
        """Cases that were taken and are not solved."""
        self._returned.append(cases)
        self.left += len(cases)


class Pace:
    """How many cases make a chunk: by what the last one took, before that by an estimate.

    Args:
        estimate: seconds per case.
        most: cases in a chunk, whatever they take.
        at_once: whether nothing is to be learned from a first chunk, nor to be compiled for it, so that more than one
            process may begin.
    """

    def __init__(self, estimate: float, most: int = CHUNK, *, at_once: bool = False) -> None:
        self.at_once = at_once
        self.seconds_per_case = estimate
        self.most = most
        self.measured = 0
        self.refused = 0
        """Chunks in a row that the machine refused to solve."""

    def learn(self, cases: int, seconds: float) -> None:
        """What some cases took in one process."""
        self.seconds_per_case = max(seconds, 1e-9) / max(cases, 1)
        self.measured += 1
        self.refused = 0

    def step(self, left: int, workers: int = 1, chunks: int = 1) -> int:
        """Cases of the next chunk, or of so many at once."""
        target = TARGET if self.measured or self.at_once else FIRST
        most = self.most * chunks
        wanted = min(target / self.seconds_per_case, most)
        if wanted < left <= min(REST * wanted, most):
            wanted = left
        if workers > 1:
            share = float(-(-left // (SHARES * workers)))
            if self.measured:
                least = LEAST / self.seconds_per_case
                share = max(share, min(least, -(-left // (2 * workers))), least / 4.0)
            wanted = min(wanted, share)
        return max(int(wanted), 1)
