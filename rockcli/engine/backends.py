"""Backend selection: which backend solves a batch."""

from __future__ import annotations

import os
from itertools import product

import numpy as np

from rockcli.errors import RockError, SolverError, StudyError
from rockcli.scene.auto import AUTO, highest
from rockcli.scene.backends import AUTOMATIC, BACKENDS, EVENT, Backend, automatic
from rockcli.scene.batch import Batch
from rockcli.study.document.tree import Source
from rockcli.study.study import BASES, Study

DECIDING = ("model", "geometry", "damping", "solver", "case")
"""Axes along which the backend may change: the first key of their paths."""


KERNELS = ("interpreted", "compiled", "ahead", "jit")
"""What ROCK_KERNELS may say of how kernels run (`rock show environment`)."""


def check_kernels() -> None:
    """`StudyError` if ROCK_KERNELS says something else."""
    word = os.environ.get("ROCK_KERNELS", "")
    if word and word not in KERNELS:
        raise StudyError(f"the environment variable ROCK_KERNELS is {word!r}; expected {', '.join(KERNELS)} or nothing")


def check_backend(study: Study) -> None:
    """`StudyError` if no backend, or not the one asked for, can solve any case of a study, or one of its bases.

    Its line is that of the base or else of the first key that decides on it and that the sentence names.
    Where an axis decides on it, single cases are refused when they are solved.
    """
    if any(axis.path.split(".")[0] in DECIDING for axis in study.axes):
        return
    for point in product(*(range(axis.size) if axis.path in BASES else (0,) for axis in study.axes)):
        index = np.ravel_multi_index((0, *point), (1, *study.shape))
        try:
            _, batch = next(iter(study.batches(np.array([index]))))
        except RockError:
            continue  # a bad case never loses the others
        try:
            choose(batch)
        except SolverError as refused:
            at = [f"vary.{axis.path}[{i}]" for axis, i in zip(study.axes, point, strict=True) if axis.path in BASES]
            named = [*at, *(key for key in study.places if key.rsplit(".", 1)[-1] in refused.message)]
            message = f"{', '.join(at) or 'case'}: {refused} (rock show backends: what each solves)"
            raise Source(study.file).placed(study.places[named[0]] if named else None, message) from None


def choose(batch: Batch) -> Backend:
    """Backend of a batch; `SolverError` if the one asked for, or for `auto` every one, cannot solve it.

    That of a batch of model auto is the backend of the highest model that its cases may need.
    """
    asked = batch.numerics.backend
    if batch.model == AUTO and asked in (AUTOMATIC, EVENT):
        batch = highest(batch)
    if asked != AUTOMATIC and asked not in BACKENDS:
        raise SolverError(f"there is no backend {asked!r}; there are {', '.join(BACKENDS)}")
    scheme = batch.damping.scheme
    row = automatic(batch.model, batch.geometry, scheme) if asked == AUTOMATIC else BACKENDS[asked]
    if row is not None and row.supports(batch):
        if why := row.refuses(batch):
            raise SolverError(why)
        return row.of_model(batch.model)
    what = f"model {batch.model!r}" + (f" ({batch.geometry})" if batch.geometry else "")
    able = [each.name for each in BACKENDS.values() if each.supports(batch)]
    if asked == AUTOMATIC and able:
        mend = f"write solver: {{backend: {able[0]}}}" + "".join(f", or {name}" for name in able[1:])
        raise SolverError(f"backend auto takes none that solves {what} with damping {scheme!r}: {mend}")
    who = "no backend" if asked == AUTOMATIC else f"backend {asked!r} does not"
    verb = "solves" if asked == AUTOMATIC else "solve"
    raise SolverError(f"{who} {verb} {what} with damping {scheme!r}")
