"""The input deck of CalculiX: what is solved, as text (docs/calculix.md, sections 1 and 2)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.solvers.calculix.mesh import Mesh

Array = NDArray[np.float64]

INCLINATION = np.pi / 4.0
"""Angle of the struts of the base to the vertical: a node slides when |T| > tan(INCLINATION) N."""

TAIL = 1e-4
"""Tension of an open strut at infinity over the weight: how far its kink is rounded."""

SMALLEST = 1e-7
"""Smallest increment CalculiX may cut down to, over the largest."""


def number(x: float) -> str:
    """A number as CalculiX reads it: it takes 20 characters, and of a longer one the last digits of the exponent go."""
    return f"{x:.13g}"


@dataclass(frozen=True, eq=False)
class Deck:
    """One case.

    Attributes:
        mesh: the body's.
        E, nu, rho: modulus [Pa], Poisson's ratio, density [kg/m³].
        kw: stiffness of the base [N/m³].
        g: gravity [m/s²].
        beta: damping matrix over current stiffness matrix of the body [s].
        dissipation: alpha of the Hilber-Hughes-Taylor integrator in [-1/3, 0], 0 without numerical dissipation.
        theta_0: rotation of the base at t = 0 [rad]: pulled there by a uniform horizontal load, which is then gone.
        t_stop: end of the run [s]; dt: largest increment [s].
        t, a_g, a_v: ground acceleration, (k,) [s, m/s²], linear between, t from 0 to t_stop.
    """

    mesh: Mesh
    E: float
    nu: float
    rho: float
    kw: float
    g: float
    beta: float
    dissipation: float
    theta_0: float
    t_stop: float
    dt: float
    t: Array
    a_g: Array
    a_v: Array

    @property
    def mass(self) -> float:
        """Mass of the body [kg]."""
        return float(self.rho * self.mesh.depth * self.mesh.nodes[:, 1].max() * self.mesh.share.sum())

    @property
    def strut(self) -> Array:
        """Stiffness of each of the two struts under a base node, (across + 1,) [N/m]."""
        return np.asarray(0.5 * self.kw * self.mesh.depth * self.mesh.share / np.cos(INCLINATION) ** 2)

    @property
    def t_static(self) -> float:
        """Length of the static steps before t = 0 on CalculiX's total time [s]."""
        return 1.0 if self.theta_0 == 0.0 else 2.0

    def text(self) -> str:
        """The deck as CalculiX reads it."""
        return "\n".join([*self._body(), *self._base(), *self._motion(), *self._statics(), *self._dynamics(), ""])

    def _body(self) -> Iterable[str]:
        mesh = self.mesh
        yield "*NODE, NSET=BODY"
        for i, (x, y, z) in enumerate(mesh.nodes, start=1):
            yield f"{i}, {number(x)}, {number(y)}, {number(z)}"
        yield "*ELEMENT, TYPE=C3D8I, ELSET=SOLID"
        for e, nodes in enumerate(mesh.bricks + 1, start=1):
            yield ", ".join(str(n) for n in (e, *nodes))
        yield "*NSET, NSET=FRONT, GENERATE"
        yield f"1, {mesh.layer}"
        yield "*NSET, NSET=WATCHED"
        yield from (f"{n + 1}," for n in (*mesh.base, *mesh.top))
        yield "*MATERIAL, NAME=BODY"
        yield "*ELASTIC"
        yield f"{number(self.E)}, {number(self.nu)}"
        yield "*DENSITY"
        yield f"{number(self.rho)}"
        if self.beta > 0.0:
            yield f"*DAMPING, ALPHA=0., BETA={number(self.beta)}"
        yield "*SOLID SECTION, ELSET=SOLID, MATERIAL=BODY"
        # plane stress: both layers move alike in the plane, the back is free to move out of it
        yield "*EQUATION"
        for n in range(1, mesh.layer + 1):
            for axis in (1, 2):
                yield "2"
                yield f"{n + mesh.layer}, {axis}, 1., {n}, {axis}, -1."

    def _base(self) -> Iterable[str]:
        mesh = self.mesh
        node, element = len(mesh.nodes), len(mesh.bricks)
        tail = TAIL * self.mass * self.g
        sin, cos = np.sin(INCLINATION), np.cos(INCLINATION)
        for n, stiffness in zip(mesh.base, self.strut, strict=True):
            x, y, z = mesh.nodes[n]
            for side in (-1.0, 1.0):
                node, element = node + 1, element + 1
                yield "*NODE, NSET=GROUND"
                yield f"{node}, {number(x)}, {number(y)}, {number(z)}"
                yield f"*ELEMENT, TYPE=GAPUNI, ELSET=STRUT{element}"
                yield f"{element}, {node}, {n + 1}"
                yield f"*GAP, ELSET=STRUT{element}"
                yield f"0., {number(side * sin)}, {number(cos)}, 0., , {number(stiffness)}, {number(tail)}"
        yield "*BOUNDARY"
        yield "GROUND, 1, 3"
        yield "FRONT, 3, 3"
        if self.theta_0 != 0.0:
            handle, left, right = self._handle()
            yield "*NODE, NSET=HANDLE"
            yield f"{handle}, 0., 0., 0."
            yield "*EQUATION"
            yield "3"
            yield f"{left}, 2, 1., {right}, 2, -1., {handle}, 1, -1."

    def _handle(self) -> tuple[int, int, int]:
        """Numbers of the node whose u_x is the rise of the left corner above the right, and of these corners."""
        handle = len(self.mesh.nodes) + 2 * len(self.mesh.base) + 1
        return handle, int(self.mesh.base[0]) + 1, int(self.mesh.base[-1]) + 1

    def _output(self) -> Iterable[str]:
        yield "*NODE PRINT, NSET=WATCHED, FREQUENCY=1"
        yield "U"

    def _statics(self) -> Iterable[str]:
        yield "*STEP, NLGEOM, INC=1000"
        yield "*STATIC"
        yield "0.1, 1., 1e-6, 1."
        if self.theta_0 != 0.0:
            yield "*BOUNDARY"
            yield f"{self._handle()[0]}, 1, 1, 0."
        yield "*DLOAD"
        yield f"SOLID, GRAV, {number(self.g)}, 0., -1., 0."
        # the first of all steps has to ask for energy if a dynamic one is to follow
        yield f"*EL PRINT, ELSET=SOLID, FREQUENCY={_NEVER}, TOTALS=ONLY"
        yield "ELSE"
        yield from self._output()
        yield "*END STEP"
        if self.theta_0 != 0.0:
            yield "*STEP, NLGEOM, INC=10000"
            yield "*STATIC"
            yield "0.01, 1., 1e-8, .05"
            yield "*BOUNDARY"
            width = self.mesh.share.sum()
            yield f"{self._handle()[0]}, 1, 1, {number(width * np.sin(self.theta_0))}"
            # the handle then carries next to nothing, and letting it go does not shake the base
            lean = np.arctan2(width, self.mesh.nodes[:, 1].max()) - abs(self.theta_0)
            yield "*DLOAD"
            yield f"SOLID, GRAV, {number(self.g * np.tan(lean))}, {number(np.sign(self.theta_0))}, 0., 0."
            yield from self._output()
            yield "*END STEP"

    def _dynamics(self) -> Iterable[str]:
        yield f"*STEP, NLGEOM, INC={_NEVER}"
        yield f"*DYNAMIC, ALPHA={number(self.dissipation)}"
        yield f"{number(0.1 * self.dt)}, {number(self.t_stop)}, {number(SMALLEST * self.dt)}, {number(self.dt)}"
        if self.theta_0 != 0.0:
            yield "*BOUNDARY, OP=NEW"
            yield "GROUND, 1, 3"
            yield "FRONT, 3, 3"
        yield "*DLOAD, OP=NEW, AMPLITUDE=DOWN"
        yield "SOLID, GRAV, 1., 0., -1., 0."
        yield "*DLOAD, AMPLITUDE=ACROSS"
        yield "SOLID, GRAV, 1., 1., 0., 0."
        yield from self._output()
        yield "*END STEP"

    def _motion(self) -> Iterable[str]:
        for name, values in (("ACROSS", -self.a_g), ("DOWN", self.g + self.a_v)):
            yield f"*AMPLITUDE, NAME={name}"
            for t, value in zip(self.t, values, strict=True):
                yield f"{number(t)}, {number(value)}"


_NEVER = 100_000_000
