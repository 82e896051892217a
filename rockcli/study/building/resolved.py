"""Collects what building the cases shows: output time step, processing of records, plausibility warnings."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.auto import AUTO
from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import Channel, Pulses, Samples
from rockcli.scene.laws.models import DEFORMABLE
from rockcli.study.building.ground_motion import MOTION
from rockcli.study.building.numbers import Numbers
from rockcli.study.building.scaling import Scaling, scaling_key
from rockcli.study.document.tree import Keys, Map, value_at
from rockcli.study.falling_ground import FallingGround
from rockcli.study.plausibility import (
    STILL,
    Strong,
    Uplift,
    doubt_density,
    doubt_friction,
    doubt_size,
    plausibility_warnings,
)

Array = NDArray[np.float64]

DT_OUT = 0.005
"""Largest output spacing by default [s]."""


NO_GEOMETRY = "geometry is ignored: models 1 to 4 have two, and no case has such a model"

NO_COLUMN = "column is ignored: models flexible, continuum, auto and 4 read it, and no case has such a model"

MOST_USES = 20
"""Ways in which one motion is used that are told."""


@dataclass(eq=False)
class Use:
    """A record used in one way: its files, the steps of its processing, and how it is scaled."""

    files: tuple[str, ...]
    steps: tuple[str, ...]
    scaling: Scaling


@dataclass(eq=False)
class Found:
    """What the cases of a study show: finest output spacing needed, what was done to records.

    `still`: no case has a motion or an initial state.  `models`: (model, geometry) of the cases; `schemes` of damping.
    `said`: keys of cases that few models read.
    `friction`: some case has a mu; `unheld`: the first body that has none.
    `asymmetric`: some body has two different edges; `rolling`: some body rolls over more.
    `meant`: keys whose numbers are not implausible.  `doubts`: sentences, with the first case each is about.
    """

    dt_out: float = DT_OUT
    uses: dict[str, Use] = field(default_factory=dict)
    more: dict[str, None] = field(default_factory=dict)
    still: bool = True
    models: dict[tuple[str, str | None], None] = field(default_factory=dict)
    schemes: set[str] = field(default_factory=set)
    said: set[str] = field(default_factory=set)
    friction: bool = False
    unheld: str | None = None
    asymmetric: bool = False
    rolling: bool = False
    meant: frozenset[Keys] = frozenset()
    implausible: dict[str, None] = field(default_factory=dict)
    doubts: dict[str, str] = field(default_factory=dict)
    strong: Strong = field(default_factory=Strong)
    uplift: Uplift = field(default_factory=Uplift)
    falling: FallingGround = field(default_factory=FallingGround)

    def look(self, numbers: Numbers, batch: Batch) -> None:
        """Take note of a batch and of the numbers it was built from."""
        self.models[batch.model, batch.geometry] = None
        self.schemes.add(batch.damping.scheme)
        self.said |= {key for key in ("geometry", "column") if getattr(numbers.case, key) is not None}
        held = np.isfinite(batch.block.mu)
        self.friction |= bool(held.any())
        if self.unheld is None and not held.all():
            self.unheld = numbers.named(int(np.argmin(held)), "mu")
        self.asymmetric |= not batch.block.symmetric.all()
        self.rolling |= bool(batch.block.rolls.any())
        pushed = batch.slide_rate_0 is not None and batch.slide_rate_0.any()
        self.still &= not (batch.theta_0.any() or batch.theta_dot_0.any() or pushed)
        self.implausible |= dict.fromkeys(plausibility_warnings(numbers, batch, self.strong, self.meant))
        doubt_size(numbers, batch)
        doubt_friction(numbers, batch)
        doubt_density(numbers)
        self.doubts |= {said: numbers.named(i) for said, i in numbers.doubts.items() if said not in self.doubts}
        self.uplift.look(batch)
        self.falling.look(batch)
        self._channel(numbers, batch, batch.excitation.horizontal, MOTION)
        self._channel(numbers, batch, batch.excitation.vertical, (*MOTION, "vertical"))
        if (suite := batch.excitation.suite) is not None:
            self.still = False
            tan_alpha = batch.block.of_weak_edge(batch.block.tan_alpha)
            for record, rows in suite.cases():
                one = replace(record, factor=suite.factor[rows])
                self._record(one, batch.g[rows], tan_alpha[rows], scaling_key(numbers, MOTION))

    def _channel(self, numbers: Numbers, batch: Batch, channel: Channel | None, keys: Keys) -> None:
        self.still &= channel is None
        if isinstance(channel, Pulses):
            self.dt_out = min(self.dt_out, float(np.min(2.0 * np.pi / channel.omega_p)) / 200.0)
        elif isinstance(channel, Samples):
            tan_alpha = batch.block.of_weak_edge(batch.block.tan_alpha)
            self._record(channel, batch.g, tan_alpha, scaling_key(numbers, keys))

    def _record(self, samples: Samples, g: Array, tan_alpha: Array, key: str) -> None:
        self.dt_out = min(self.dt_out, samples.dt)
        self._note(samples, Scaling.of(samples, g, tan_alpha, key))

    def _note(self, samples: Samples, scaling: Scaling) -> None:
        name = samples.name
        if name in self.uses and self.uses[name].files != samples.files:  # two files of one name
            name = " + ".join(samples.files)
        label, k = name, 1
        while label in self.uses and not self._same_use(self.uses[label], samples, scaling):  # used in two ways
            k += 1
            label = f"{name} ({k})"
            if k > MOST_USES:  # as many as there are samples of an uncertain floor
                self.more[name] = None
                return
        known = self.uses.get(label)
        self.uses[label] = Use(
            samples.files, samples.processing, scaling if known is None else known.scaling.with_(scaling)
        )

    @staticmethod
    def _same_use(use: Use, samples: Samples, scaling: Scaling) -> bool:
        return use.files == samples.files and use.steps == samples.processing and use.scaling.key == scaling.key

    def processing(self) -> dict[str, tuple[str, ...]]:
        """What was done to each record, sentences in order, that about its scaling last."""
        told = {
            label: (*use.steps, *((use.scaling.sentence(),) if use.files else ()))  # a pulse has its own amplitude
            for label, use in self.uses.items()
        }
        return told | {f"{name} (...)": (f"used in more than {MOST_USES} ways",) for name in self.more}

    def plausibility_warnings(self, study: Map, size: int) -> list[str]:
        """Sentences about what is hardly meant in a study of `size` cases, or not described by its models."""
        curves: Any = value_at(study, ("curves",))
        nothing_moves = self.still and not curves and "fema356" not in self.schemes
        for_nothing = "geometry" in self.said and not self._knows_geometry
        no_column = "column" in self.said and not self._reads_column
        unread = [NO_GEOMETRY] * for_nothing + [NO_COLUMN] * no_column
        doubts = [f"{said} (at {first})" if first else said for said, first in self.doubts.items()]
        said = [*self.uplift.sentences(), *self.falling.sentences(size), *self.strong.sentences()]
        return [STILL] * nothing_moves + unread + said + list(self.implausible) + doubts

    @property
    def _knows_geometry(self) -> bool:
        """Whether a case has a model of two geometries, or may be given one."""
        return any(geometry is not None or model == AUTO for model, geometry in self.models)

    @property
    def _reads_column(self) -> bool:
        """Whether a case has a model that is made of a column, or of elements."""
        return any(model in (*DEFORMABLE, AUTO, "4") for model, _ in self.models)
