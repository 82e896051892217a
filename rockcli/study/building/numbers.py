"""The numbers of a batch of cases: expressions evaluated on arrays, once per batch, when they are asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NoReturn, Protocol

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.body.block import Block
from rockcli.scene.laws.damping import HOUSNER
from rockcli.study.document.check import said_at
from rockcli.study.document.dimensions import check_unit
from rockcli.study.document.expressions import CONSTANTS, FUNCTIONS, SYMBOLS, ExpressionError, Value, parse
from rockcli.study.document.tree import Keys, Map, Source, Where, meant, nearest, place, value_at
from rockcli.study.document.values import WEAKEST
from rockcli.study.schema import CasePart

Array = NDArray[np.float64]

LARGEST = 1e60
"""Motions and their times are smaller than this, so that products of a few of them are numbers still."""


_WORDS: dict[Keys, str] = {("damping", "eta"): HOUSNER, ("block", "direction"): WEAKEST}
"""Words that keys of numbers take too."""


class Varied(float):
    """Stands in the tree where an axis puts a different number into every case; its value is that of the first."""

    axis: int
    column: int

    @classmethod
    def of(cls, axis: int, column: int, first: float) -> Varied:
        """The number of one column of an axis."""
        varied = cls(first)
        varied.axis, varied.column = axis, column
        return varied


@dataclass(frozen=True, eq=False)
class Motions:
    """Recorded motions that an axis makes: files, or directions of two components.

    Attributes:
        keys: where the axis stands, the record's `file` or `angle`.
        points: the names of the files or the angles [rad], each with its place in the study.
        which: place of each case's motion among them, (n,).
    """

    keys: Keys
    points: tuple[tuple[Any, Where], ...]
    which: NDArray[np.int64]

    @property
    def directions(self) -> bool:
        """Whether they are directions."""
        return self.keys[-1] == "angle"


def in_range(numbers: Numbers, keys: Keys, value: Any) -> None:
    """Refuse what is so large that its square would overflow; raises StudyError."""
    message = f"is out of range: it makes values of {LARGEST:g} and more (SI units)"
    numbers.require(keys, np.less(np.abs(value), LARGEST), message)


def in_words(keys: tuple[str | int, ...], text: str, message: str) -> str:
    """What is wrong with an expression; at a key that also takes a word, the word that may have been meant."""
    word = _WORDS.get(keys[-2:])
    if word is not None and f"`{text.strip()}` is not known" in message and meant(text, [word]):
        return f"{text!r} is no number; did you mean {word!r}?"
    return message


class Spot(Protocol):
    """Tells where a case is said, and its values of the axes."""

    def __call__(self, varied: Varied | None, i: int, *, bodies: bool = False) -> tuple[Where, str]:
        """Place of the number of an axis in case i, and the values of all axes there, or of those that make bodies."""


class Numbers:
    """Looks numbers up in the tree of `n` cases that differ only in the columns of some axes.

    Args:
        source: for errors.
        tree: {case, let} as it is written, with `Varied` where an axis stands: for the places of errors.
        case: the same case, validated: what is read.
        n: number of cases.
        column: (axis, column) -> (n,) values.
        spot: (number of an axis, i) -> its place in case i, and the values of all axes there, or of those that make
            bodies, as text.
        pair, body: how the block with its two sizes, and from it the body, come of these numbers (`building.body`).
        suite: the recorded motions, where each case has its own.

    Attributes:
        remarks: sentences about what was made of them.
        doubts: sentences about what the body of some case makes of the study, each with the first such case.
    """

    def __init__(
        self,
        source: Source,
        tree: Map,
        case: CasePart,
        n: int,
        column: Callable[[int, int], Array],
        spot: Spot,
        pair: Callable[[Numbers], Block],
        body: Callable[[Numbers, Block], Block],
        suite: Motions | None = None,
    ) -> None:
        self.source, self.tree, self.case, self.n = source, tree, case, n
        self._column, self._spot, self.suite = column, spot, suite
        self._make_pair, self._make_body = pair, body
        self.remarks: list[str] = []
        self.doubts: dict[str, int] = {}
        self._symbols: dict[str, Value] = {}
        self._busy: list[str] = []
        self._pair: Block | None = None
        self._block: Block | None = None
        self._p: Array | None = None

    def value(self, keys: Keys) -> Value | None:
        """The number at `keys`, a float or (n,); None where the study gives none.

        Raises:
            StudyError: an expression that cannot be evaluated.
        """
        if self.suite is not None and self.suite.directions and keys == self.suite.keys:
            return np.array([angle for angle, _ in self.suite.points])[self.suite.which]
        found = self.said(keys)
        if found is None:
            return None
        if isinstance(found, Varied):
            return self._column(found.axis, found.column)
        if not isinstance(found, str):
            return float(found)
        try:
            value = parse(found).evaluate(self.symbol)
            check_unit(found, keys, self.tree["let"])
        except ExpressionError as error:
            self.fail(keys, in_words(keys, found, str(error)), error.index)
        return value

    def said(self, keys: Keys) -> Any:
        """What the study says at `keys`, or the default of the schema."""
        return said_at(self.case, keys[1:]) if keys[0] == "case" else value_at(self.tree, keys)

    def constant(self, keys: Keys) -> float | None:
        """A number that is the same in every case of the batch; None where the study gives none."""
        value = self.value(keys)
        if value is None or isinstance(value, float):
            return value
        if (value == value[0]).all():
            return float(value[0])
        self.fail(keys, "must be the same in all cases that differ only in numbers")

    def array(self, value: Value) -> Array:
        """A number of every case, (n,); read-only, and one row that stands for all where it is the same in all."""
        return np.broadcast_to(np.asarray(value, dtype=np.float64), (self.n,))

    def require(self, keys: Keys, good: Any, message: str) -> None:
        """Raise StudyError about `keys` at the first case where `good`, a bool, (n,) or (n, ...), is not all true."""
        if not np.all(good):
            rows = np.reshape(good, (len(good), -1)).all(axis=1) if np.ndim(good) > 1 else good
            self.fail(keys, message, int(np.argmin(np.broadcast_to(rows, (self.n,)))))

    def positive(self, keys: Keys) -> Value | None:
        """The number at `keys`, which must be greater than zero; None where the study gives none."""
        value = self.value(keys)
        if value is not None:
            self.require(keys, np.greater(value, 0.0), "must be greater than 0")
        return value

    def not_negative(self, keys: Keys) -> Value | None:
        """The number at `keys`, which must not be below zero; None where the study gives none."""
        value = self.value(keys)
        if value is not None:
            self.require(keys, np.greater_equal(value, 0.0), "must not be negative")
        return value

    def fail(self, keys: Keys, message: str, i: int | None = None) -> NoReturn:
        """Raise StudyError about the value at `keys` in case i."""
        found = value_at(self.tree, keys)
        suffix, context, where = "", "", place(self.tree, keys)
        if i is not None:
            varied = found if isinstance(found, Varied) else None
            at, context = self._spot(varied, i)
            where = where if at is None else at
            if varied is not None:
                suffix = f" = {self._column(varied.axis, varied.column)[i]:.10g}"
            elif isinstance(found, int | float) and not isinstance(found, bool):
                suffix = f" = {found:.10g}"
        name = ".".join(str(key) for key in keys)
        raise self.source.placed(where, f"{name}{suffix}: {message}{f' (at {context})' if context else ''}")

    def fail_body(self, keys: Keys, message: str) -> NoReturn:
        """Raise StudyError about the body given at `keys`, with the values of the axes that make it."""
        _, context = self._spot(None, 0, bodies=True)
        self.fail(keys, f"{message} (at {context})" if context else message)

    def named(self, i: int, key: str = "") -> str:
        """Body of case i by the axes that make it, and where it is said: `block.alpha = 1, study.yaml:5`.

        `key`: one of the block that is taken away, and where that is said.
        """
        keys: Keys = ("case", "block")
        block: Map = value_at(self.tree, keys)
        varied = next(((key, item) for key, item in block.items() if isinstance(item, Varied)), None)
        at, context = self._spot(None if varied is None else varied[1], i, bodies=True)
        at = block.where.get(key, at)
        where = self.source.words(place(self.tree, keys) if at is None else at)
        return ", ".join(filter(None, (context, where)))

    def symbol(self, name: str) -> Value:
        """Value of a name in an expression: g, the block's, `let`, units and pi."""
        if name in CONSTANTS:
            return CONSTANTS[name]
        if name in self._symbols:
            return self._symbols[name]
        let = self.tree["let"]
        if name in self._busy:
            raise ExpressionError(
                f"`{name}` needs itself: {' -> '.join([*self._busy[self._busy.index(name) :], name])}"
            )
        self._busy.append(name)
        try:
            if name == "g":
                value: Value | None = self.g
            elif name in let:
                value = self.value(("let", name))
            elif name in SYMBOLS:
                value = self._of_block(name)
            elif name.lower() in ("nan", "inf", "infinity"):
                raise ExpressionError(f"{name!r} is no finite number")
            else:
                known = ["g", *SYMBOLS, *let, *CONSTANTS, *FUNCTIONS]
                raise ExpressionError(f"`{name}` is not known; {nearest(name, known)}")
        finally:
            self._busy.pop()
        assert value is not None
        self._symbols[name] = value
        return value

    def let(self, name: str) -> Value:
        """Value of a symbol of `let`; raises StudyError."""
        try:
            return self.symbol(name)
        except ExpressionError as error:
            self.fail(("let", name), str(error), error.index)

    @property
    def g(self) -> Value:
        """Acceleration of gravity, a float or (n,) [m/s²]."""
        value = self.positive(("case", "g"))
        assert value is not None
        return value

    def _of_block(self, name: str) -> Value:
        if name == "p":
            return self.block.of_weak_edge(self.p)
        block = self._block or self._pair_block()
        both = {"R": block.R, "alpha": block.alpha, "tan_alpha": block.tan_alpha, "b": block.b}
        return block.h if name == "h" else block.of_weak_edge(both[name])

    def _pair_block(self) -> Block:
        if self._pair is None:
            if "the block" in self._busy:
                raise ExpressionError(f"needs `{self._busy[-1]}`, which is known only once the block is")
            self._busy.append("the block")
            try:
                self._pair = self._make_pair(self)
            finally:
                self._busy.pop()
        return self._pair

    @property
    def block(self) -> Block:
        """The body of every case.

        Raises:
            StudyError: over- or under-determined, or not a body.
        """
        if self._block is None:
            pair = self._pair_block()
            if "the body" in self._busy:
                raise ExpressionError("needs `p`, which is known only once the block is")
            self._busy.append("the body")
            try:
                self._block = self._make_body(self, pair)
            finally:
                self._busy.pop()
        return self._block

    @property
    def p(self) -> Array:
        """Frequency parameter of each edge, (n, 2) [rad/s]; raises StudyError."""
        if self._p is None:
            self._p = self.block.p(self.array(self.g))
        return self._p
