"""The script of a case as plain text: its numbers on top, then the pieces it needs."""

from __future__ import annotations

from dataclasses import dataclass

from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import Samples
from rockcli.solvers.opensees import loop, pieces
from rockcli.solvers.opensees.case import CaseOfOpenSees, case_of

HEAD = '''\
#!/usr/bin/env python3
"""{title}

{what}, damping {damping}.  Ground motion: {motion}.
Needs openseespy (pip install openseespy; on Debian also libblas3 and liblapack3).
Reads {reads}; writes {name}_results.txt and {name}_summary.json beside itself.
SI units, radians.  theta is positive clockwise, to the right; positive a_g drives it negative.
"""

'''


@dataclass(frozen=True)
class Script:
    """A script and what lies beside it.

    Attributes:
        name: file name of the script without .py.
        files: name -> content of all files, the script `<name>.py` first.
        case: the numbers it is made of.
    """

    name: str
    files: dict[str, str]
    case: CaseOfOpenSees

    @property
    def outputs(self) -> tuple[str, str]:
        """Names of the table of results and of the summary that it writes."""
        return f"{self.name}_results.txt", f"{self.name}_summary.json"


def script_of(batch: Batch, i: int, *, name: str = "case", title: str = "", coarser: float = 1.0) -> Script:
    """The script of case i of a batch; `coarser` multiplies its time step and yield rotation.

    Raises:
        SolverError: OpenSees cannot do what the case asks for.
    """
    case = case_of(batch, i, coarser=coarser)
    motions = {f"{name}_{which}.txt": text for which, text in zip(("a_g", "a_v"), case.motions, strict=True)}
    files = {file: text for file, text in motions.items() if text is not None}
    what = f"Model {batch.model}" + (f", {batch.geometry}" if batch.geometry else "")
    head = HEAD.format(
        title=_one_line(title) or "A rocking body in OpenSeesPy.",
        what=what,
        damping=batch.damping.scheme,
        motion=_motion(batch, i),
        reads=", ".join(files) or "nothing",
        name=name,
    )
    names = [("LOG", f"{name}_opensees.log", "messages of OpenSees")]
    names += [
        ("RESULTS", f"{name}_results.txt", "histories"),
        ("SUMMARY", f"{name}_summary.json", "peaks, impacts, end"),
    ]
    for parameter, file in (("MOTION", f"{name}_a_g.txt"), ("VERTICAL", f"{name}_a_v.txt")):
        if file in files:
            names.append((parameter, file, "ground acceleration [m/s2], one value per line"))
    lines = [f"{key} = {value!r}  # {comment}" for key, value, comment in [*case.parameters, *names]]
    top = "# ---------------------------------------------------------------- parameters\n" + "\n".join(lines) + "\n"
    text = head + "\n".join([pieces.IMPORTS, top, *_body(batch, case)])
    return Script(name, {f"{name}.py": text, **files}, case)


def _motion(batch: Batch, i: int) -> str:
    """The horizontal ground motion in words."""
    channel = batch.excitation.horizontal
    if channel is None:
        return "none, free rocking"
    if isinstance(channel, Samples):
        return _one_line(f"{channel.name or 'a record'}, times {channel.factor[i]:.6g}")
    return f"{channel.shape}, a_p = {channel.a_p[i]:.6g} m/s2, omega_p = {channel.omega_p[i]:.6g} rad/s"


def _one_line(text: str) -> str:
    """Words that can stand in a docstring."""
    return " ".join(text.replace("\\", "/").replace('"', "'").split())


def _body(batch: Batch, case: CaseOfOpenSees) -> list[str]:
    """The pieces in the order of the script; what belongs together is joined."""
    return ["".join(part) for part in (_model(batch, case), _loads(batch, case), _analysis(batch, case)) if part]


def _model(batch: Batch, case: CaseOfOpenSees) -> list[str]:
    fibres, known = case.law == "fibres", case.values
    parts = [pieces.BEGIN, pieces.COLUMN_OF_MODEL[case.kind]]
    if "n" in known:
        parts.append(pieces.SPREAD)
        parts.append(pieces.CONSISTENT if case.consistent else pieces.LUMPED)
        parts.append(pieces.LACKING.format(moved=pieces.MOVED if fibres else ""))
    linear = batch.numerics.method == "linear"
    parts.append(pieces.NODES + (pieces.ON_FIBRES if fibres else pieces.HINGED))
    parts.append(f'TRANSFORMATION = "{"Linear" if linear else "Corotational"}"\n')
    if "zeta" in known:
        parts.append(pieces.STIFFNESS_DAMPING.format(integrator=" * alpha_d" if "alpha_d" in known else ""))
    mass, damping = pieces.ELEMENT_MASS * case.consistent, pieces.ELEMENT_DAMPING * ("zeta" in known)
    parts.append(pieces.ELEMENTS.format(mass=mass, damping=damping))
    parts.append("\n")
    parts.append(pieces.FIBRES if fibres else pieces.SPRING_OF_LAW[case.law] + pieces.SPRING)
    if "c" in known:
        parts.append("\n\n" + pieces.DASHPOT)
    return [*parts, "\n"]


def _loads(batch: Batch, case: CaseOfOpenSees) -> list[str]:
    parts = [*([] if case.law == "softening" else [pieces.GRAVITY, "\n"]), *_initial(batch, case)]
    horizontal, vertical = case.motions
    if horizontal is not None and case.consistent:
        parts.append(pieces.NODAL_PULL)
    elif horizontal is not None:
        uniform = pieces.UNIFORM.split("\n", 1)
        note = "" if batch.model == "2" else pieces.UNIFORM_FROM_NODES
        parts.append(uniform[0] + "\n" + note + uniform[1])
    if vertical is not None:
        parts.append(pieces.VERTICAL_PULL if case.consistent else pieces.VERTICAL)
    return parts


def _initial(batch: Batch, case: CaseOfOpenSees) -> list[str]:
    known = case.values
    if not (known["theta_0"] or known["theta_dot_0"]):
        return []
    how = pieces.INITIAL_LIFTED if case.law == "fibres" else pieces.INITIAL_TURNED
    moved, rates = pieces.INITIAL_LINEAR if batch.numerics.method == "linear" else how
    rise = pieces.RISE if case.law == "fibres" else ""
    held = pieces.HELD if batch.model == "flexible" else ""
    return [pieces.INITIAL.format(rise=rise, moved=moved, moving=rates), held, "\n"]


def _analysis(batch: Batch, case: CaseOfOpenSees) -> list[str]:
    parts = [pieces.ANALYSIS.format(integrator=pieces.HHT if "alpha_d" in case.values else pieces.NEWMARK)]
    parts.append("\n\n" + (loop.TOP_FLEXIBLE if batch.model == "flexible" else loop.TOP_RIGID))
    yields = case.law in ("winkler", "fibres")
    return [*parts, "\n\n", loop.ADVANCE, loop.UPLIFTED[yields], loop.LOOP, "\n", loop.WRITE]
