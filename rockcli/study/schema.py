"""The form of a study file: every key, what it takes, its unit.  `rock show schema` prints it as JSON Schema."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WithJsonSchema,
    WrapValidator,
    create_model,
)

from rockcli.motion.options import DETRENDS, METHODS
from rockcli.scene.auto import AUTO
from rockcli.scene.backends import AUTOMATIC, BACKEND_NAMES
from rockcli.scene.body.column import ACROSS
from rockcli.scene.constants import ELEMENTS, STANDARD_G
from rockcli.scene.ground.pulses import SHAPES
from rockcli.scene.ground.spectra import SPECTRA
from rockcli.scene.laws.damping import DEFAULT_SCHEME, SCHEMES, Key
from rockcli.scene.laws.models import DEFORMABLE, MODEL_NAMES
from rockcli.scene.looks import NARROWEST, WIDEST, WIDTHS, WIDTHS_IN_WORDS
from rockcli.scene.numerics import ACCURACIES, STANDARD
from rockcli.scene.rules import RULE_NAMES as RULES
from rockcli.scene.uncertain.samples import LATIN_HYPERCUBE, SAMPLINGS
from rockcli.study.document.values import (
    LENGTHS,
    NUMBER_SCHEMA,
    PAIR_SCHEMA,
    Audit,
    Axes,
    Direction,
    Edges,
    Eta,
    Files,
    Histories,
    Label,
    MeanAndSpread,
    Meaning,
    MedianAndSpread,
    Number,
    Outline,
    Pair,
    Point,
    Quadruple,
    Scalars,
    Series,
    Site,
    Span,
    Text,
    Triple,
    describe,
)

MODELS = (*MODEL_NAMES, *DEFORMABLE, AUTO)
PLOTS = (
    "histories", "bending", "phase", "map", "ida", "fragility", "intensities", "risk", "samples", "curves", "spectrum",
    "work_precision", "body", "barriers", "boundaries", "curve", "polar", "motion", "ranking",
)  # fmt: skip
"""The kinds of `plotting.figures`, which a study cannot import; `tests/plotting/test_figures.py` compares them."""

OUTLINES = ("mesh", "parts", "outline")
"""Keys of a block of which one says the outline of the body."""

CURVES = ("moment_rotation", "pushover", "displacements", "overturning_moment", "energy_per_cycle")


class Part(BaseModel):
    """A mapping of the study: unknown keys are errors, values do not change."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True, populate_by_name=False)


def key(description: str, default: Any = None, **more: Any) -> Any:
    """A key with its sentence."""
    return Field(default, description=description, **more)


class SolidPart(Part):
    """One polygon of a body made of several."""

    outline: Outline = key("polygon [[x, z], ...] [m], or FILE.csv beside the study", ...)
    density: Number | None = key("density [kg/m³]")
    depth: Number | None = key("depth [m]; default 1")


class FrictionPart(Part):
    """Coulomb friction of the base at rest and in motion."""

    static: Number = key("coefficient that has to be overcome [1]", ...)
    kinetic: Number | None = key("coefficient while it slides [1]; default static")


Friction = Annotated[
    Annotated[Number, Tag("number")] | Annotated[FrictionPart, Tag("mapping")],
    Discriminator(lambda value: "mapping" if isinstance(value, dict) else "number"),
]


class BlockPart(Part):
    """The body: a sufficient pair of R, h or height, b or width, and one of alpha, tan_alpha, slenderness; or outlines.

    An outline stands on its lowest points; mass, centre of mass and inertia follow from it, and from a mesh.
    """

    R: Number | None = key("distance from the edge to the centre of mass [m]")
    h: Number | None = key("height of the centre of mass above the base [m]")
    b: Edges | None = key("distance from the centre of mass to the edge [m], or [left, right] of an asymmetric body")
    height: Number | None = key("full height 2h of a rectangle [m]")
    width: Number | None = key("full width 2b of a rectangle [m]")
    alpha: Number | None = key("slenderness angle atan(b/h) [rad]")
    tan_alpha: Number | None = key("tangent of the slenderness angle, b/h [1]")
    slenderness: Number | None = key("slenderness h/b [1]")
    inertia: Number | None = key("I_O/(m R^2) about the edge [1]; default 4/3, a rectangle")
    r_g: Number | None = key(
        "radius of gyration about the centre of mass [m]; default that of a rectangle of 2h by the base, also with two "
        "edges"
    )
    top: Number | None = key(
        "height of the point whose displacement is reported [m]; default 2h, or the highest point of an outline"
    )
    mass: Number | None = key("mass [kg]")
    mu: Friction | None = key("coefficient of friction of the base [1], or {static, kinetic}")
    e_n: Number | None = key("restitution of a corner that strikes the ground from flight [1]; default 0")
    outline: Outline | None = key("polygon [[x, z], ...] [m], z up, or FILE.csv beside the study")
    density: Number | None = key("density of the outline or the mesh [kg/m³]")
    depth: Number | None = key("depth of the outline, default 1, or of a rectangle that has a `plane` [m]")
    plane: Literal["width", "depth"] | None = key("side along which a rectangle rocks, one of height, width and depth")
    pixel: Number | None = key("metres in a unit of the outline's coordinates [m]; default 1")
    z_down: bool = key("the outline's z runs down, as on a photograph", False)
    contacts: Annotated[list[Point], Field(min_length=2, max_length=2)] | None = key(
        "points [x, z] of the outline's coordinates on which it stands, of a tilted support at different heights; "
        "default: its lowest points"
    )
    parts: Annotated[list[SolidPart], Field(min_length=1)] | None = key("several outlines, rigidly joined")
    stands: Literal["outline", "toes", "settled"] = key(
        "how an outline stands, on its lowest points as given, rolling over the vertices beside them (outline); on the "
        "outermost two of its lowest points alone (toes); as outline, where it comes to rest when let go (settled)",
        "outline",
    )
    centre: Point | None = key("centre of mass [x, z] in the outline's coordinates, with r_g, where it is not uniform")
    mesh: Text | None = key("closed surface of the body, z up: FILE.obj, .ply or .stl beside the study")
    units: Literal[LENGTHS] | None = key("units of the mesh; default metres, and sizes that are unlikely are refused")  # type: ignore[valid-type]
    direction: Direction | None = key(
        "direction in which the body of a mesh rocks, from its x towards its y [rad]; weakest (the default): that of "
        "the least barrier"
    )


class PulsePart(Part):
    """An analytic pulse, zero for t < 0."""

    shape: Literal[tuple(SHAPES)] = key("shape of the pulse", ...)  # type: ignore[valid-type]
    a_p: Number | None = key("peak acceleration of the pulse [m/s²]")
    a_p_over_g_tan_alpha: Number | None = key("peak acceleration of the pulse over g tan(alpha) [1]")
    omega_p: Number | None = key("circular frequency of the pulse [rad/s]")
    T_p: Number | None = key("period of the pulse [s]")
    f_p: Number | None = key("frequency of the pulse [1/s]")
    omega_p_over_p: Number | None = key("circular frequency of the pulse over the frequency parameter p [1]")
    cycles: Number | None = key("number of cycles of a sine or cosine [1]; default 1")
    t0: Number | None = key("time of the pulse [s]: its beginning, or the centre of a Ricker or wavelet")
    gamma: Number | None = key("mavroeidis_papageorgiou: half the number of half cycles [1], > 1")
    nu: Number | None = key("mavroeidis_papageorgiou: phase [rad]; default 0")
    A: Number | None = key("mavroeidis_papageorgiou: velocity amplitude [m/s], instead of a_p")


class FilterPart(Part):
    """A Butterworth highpass or lowpass of a record."""

    freq: Number = key("corner frequency [1/s]", ...)
    corners: int = key("order of the filter", 4, ge=1, le=10)
    zerophase: bool = key("run forward and back", True)


class BandpassPart(Part):
    """A Butterworth bandpass of a record."""

    freqmin: Number = key("lower corner frequency [1/s]", ...)
    freqmax: Number = key("upper corner frequency [1/s]", ...)
    corners: int = key("order of the filter", 4, ge=1, le=10)
    zerophase: bool = key("run forward and back", True)


class TaperPart(Part):
    """A taper at both ends of a record."""

    fraction: Number = key("part of the record tapered at each end [1]", ...)
    type: Text = key("shape", "cosine")


class ResamplePart(Part):
    """Another time step for a record."""

    dt: Number = key("new time step [s]", ...)
    method: Literal[METHODS] = key("how", ...)  # type: ignore[valid-type]


class RecordPart(Part):
    """A recorded motion; the keys are applied in this order, nothing by default."""

    file: Files = key(
        "file name of the record, searched for beside the study, in records/ folders, in ROCK_RECORDS; two for "
        "[H1, H2] with `angle`",
        ...,
    )
    component: str | int | list[str | int] | None = key(
        "which component of a file with several, by name or place from 0; two for two files"
    )
    units: Text | None = key("units of the file's values, for files that do not say")
    dt: Number | None = key("time step [s], for files that do not say")
    window: Pair | None = key("part kept, [from, to] [s]")
    detrend: Literal[tuple(DETRENDS)] | None = key("what is taken off")  # type: ignore[valid-type]
    taper: TaperPart | None = key("part of the length tapered at each end [1], or {fraction, type}")
    highpass: FilterPart | None = key("corner frequency [1/s], or {freq, corners, zerophase}")
    lowpass: FilterPart | None = key("corner frequency [1/s], or {freq, corners, zerophase}")
    bandpass: BandpassPart | None = key("band kept, [low, high] [1/s], or {freqmin, freqmax, corners, zerophase}")
    resample: ResamplePart | None = key("new time step, {dt [s], method}")
    scale: Number | None = key("factor on the processed record [1]")
    pga: Number | None = key("peak acceleration wanted of the record [m/s²]")
    pgv: Number | None = key("peak velocity wanted of the record [m/s]")
    pga_over_g_tan_alpha: Number | None = key("peak acceleration wanted of the record over g tan(alpha) [1]")
    sa: Number | None = key("pseudo-acceleration at 5 % damping wanted of the record [m/s²], at the period sa_period")
    sa_period: Number | None = key("natural period of the oscillator that sa is of [s]")
    polarity: Number | None = key("sign of the record, 1 or -1")
    angle: Number | None = key("direction from H1 towards H2 [rad]: a_g = H1 cos(angle) + H2 sin(angle)")


class VerticalPart(Part):
    """Vertical ground motion, upward positive."""

    pulse: PulsePart | None = key("analytic pulse")
    record: RecordPart | None = key("recorded motion; without its own scaling it takes the horizontal factor")


class OscillatorPart(Part):
    """A floor or an isolator: a linear oscillator."""

    T: Number | None = key("undamped natural period of the floor [s]")
    f: Number | None = key("natural frequency of the floor [1/s]")
    zeta: Number | None = key("damping ratio of the floor [1]")


class MotionPart(Part):
    """Ground motion: a pulse or a record, or neither for free rocking."""

    pulse: PulsePart | None = key("analytic pulse")
    record: RecordPart | None = key("recorded motion")
    vertical: VerticalPart | None = key("vertical motion, upward positive")
    through: list[OscillatorPart] | None = key("floors and isolators between the ground and the body, from below")
    floor_scale: Number | None = key("factor on what arrives through floors and isolators [1]")
    floor_pga: Number | None = key("peak acceleration wanted of what arrives through floors and isolators [m/s²]")
    duration: Number | None = key("end of the motion and of the response, from t = 0 [s]")


class InitialPart(Part):
    """State at t = 0."""

    theta: Number = key("rotation at t = 0 [rad]", 0)
    theta_dot: Number = key("angular velocity at t = 0 [rad/s]", 0)
    slide_rate: Number | None = key("velocity of the base along the ground at t = 0 [m/s]; needs a mu")


class ModelPart(Part):
    """The model by name, with what it needs."""

    name: Literal[MODELS] = key("model; auto chooses the cheapest that is accurate enough", "rigid")  # type: ignore[valid-type]
    tolerance: Number | None = key("auto: error of theta_peak_over_alpha allowed [1]; default 0.02")


class ColumnPart(Part):
    """The deformable column of the flexible models."""

    E: Number | None = key("Young's modulus of the column [Pa]")
    rho: Number | None = key("density of the column [kg/m³]")
    zeta: Number | None = key("damping ratio of the first clamped mode, stiffness-proportional [1]")
    elements: int | None = key(
        "number of elements along the height, at most 1000 (40 are converged); "
        f"default {ELEMENTS}, continuum: square elements",
        ge=1,
        le=1000,
    )
    across: int | None = key(f"continuum: number of elements across the width; default {ACROSS}", ge=1)
    mass: Literal["consistent", "lumped"] = key("mass matrix", "consistent")


class BasePart(Part):
    """What the body stands on."""

    law: Literal["rigid", "winkler"] = key("moment of the base", "rigid")
    kw: Number | None = key("Winkler stiffness [N/m³]")
    fibres: int | None = key("number of fibres, two or more", ge=2)


class SpectrumPart(Part):
    """A design spectrum of the scheme fema356."""

    shape: Literal[("motion", *SPECTRA)] | None = key("motion, or a shape; a mapping with periods is a table")  # type: ignore[valid-type]
    S_a: Series | None = key("constant and table: pseudo-acceleration [m/s²], or in g with units: g")
    S_v: Number | None = key("flat_S_v: spectral velocity [m/s]")
    periods: Series | None = key("table: ascending periods [s]")
    units: Literal["g", "m/s²"] = key("units of S_a, S_XS and S_X1", "m/s²")
    S_XS: Number | None = key("fema356: 5 % spectral acceleration at short periods [m/s²], or in g with units: g")
    S_X1: Number | None = key("fema356: 5 % spectral acceleration at 1 s [m/s²], or in g with units: g")


class FloorSpectrumPart(Part):
    """A response spectrum of the floor the body stands on, at the damping that the rule asks for."""

    periods: list[Number] = key("ascending periods [s], the first one that of the peak acceleration", ..., min_length=2)
    S_a: list[Number] = key("pseudo-acceleration at each [m/s²], or in g with units: g", ..., min_length=2)
    units: Literal["g", "m/s²"] = key("units of S_a", "m/s²")


Spectrum = Annotated[SpectrumPart | None, BeforeValidator(lambda v: {"shape": "motion"} if v == "motion" else v)]


def _of_scheme(said: Key) -> Any:
    """What a key of a damping scheme takes."""
    return Spectrum if not said.number else (Eta | None) if said.word else (Number | None)


_SCHEME_KEYS: dict[str, Any] = {
    "scheme": (Literal[tuple(SCHEMES)], key("damping scheme", DEFAULT_SCHEME)),
    **{
        said.name: (_of_scheme(said), key(f"{scheme.name}: {said.sentence}"))
        for scheme in SCHEMES.values()
        for said in scheme.keys
    },
}

DampingPart = create_model(
    "DampingPart",
    __base__=Part,
    __module__=__name__,
    __doc__="What is lost at impacts or between them.",
    **_SCHEME_KEYS,
)


class SolverPart(Part):
    """How, and how well."""

    backend: Literal[BACKEND_NAMES] = key("who solves", AUTOMATIC)  # type: ignore[valid-type]
    accuracy: Literal[tuple(ACCURACIES)] = key("named tolerances", STANDARD)  # type: ignore[valid-type]
    rtol: Number | None = key("truncation error per step, relative to alpha [1]")
    method: Text | None = key("method of the backend")
    events: bool | None = key("whether impacts are located")
    dt: Number | None = key("time step [s]")
    yield_rotation: Number | None = key("penalty backends: rotation at which the base yields [rad]")


class CasePart(Part):
    """What is solved; every number is SI, radians, or an expression."""

    g: Number = key("acceleration of gravity [m/s²]", STANDARD_G)
    block: BlockPart = key("the body", ...)
    motion: MotionPart = key("ground motion; none = free rocking", MotionPart.model_construct())
    initial: InitialPart = key("state at t = 0", InitialPart.model_construct())
    model: ModelPart = key(
        "model of the body; rigid, linearized, 1, 2, 3, 4, flexible, continuum, auto, or {name: auto, tolerance}",
        ModelPart.model_construct(),
    )
    geometry: Literal["negative_stiffness", "corotational"] | None = key("restoring law of models 1-4")
    column: ColumnPart | None = key("the column of the flexible models")
    base: BasePart | None = key("the base; default rigid")
    damping: DampingPart = key("damping, what is lost", DampingPart.model_construct())  # type: ignore[valid-type]
    solver: SolverPart = key("how it is solved", SolverPart.model_construct())


class SavePart(Part):
    """What is kept."""

    histories: Histories | None = key("true, false or {axis: value}; default true for <= 100 cases")
    dt_out: Number | None = key("output spacing [s]; default min(0.005 s, T_p/200, record dt)")
    scalars: Scalars | None = key("all, or a list; default all for <= 100 000 cases, with `uncertain` <= 10 000")


Target = Annotated[Any, WithJsonSchema({"type": ["number", "string"]})]


class ExpectPart(Part):
    """A statement about the results that makes the study its own test."""

    quantity: Text = key("a variable of the dataset", ...)
    at: dict[str, Any] = key("{axis: value}; an absent axis = every point", {})
    time: Number | None = key("time at which a history is read [s]")
    rotation: Number | None = key("theta/alpha at which a static curve is read [1]")
    value: Target | None = key("what it is")
    rtol: Number = key("relative tolerance on value [1]", 1e-6)
    atol: Number = key("absolute tolerance on value", 0)
    min: Target | None = key("at least this")
    max: Target | None = key("at most this")
    is_: Meaning | None = key("outcome: a meaning, a list of them, or `overturned`", alias="is")
    is_not: Meaning | None = key("outcome: none of these")
    references: Text = key("where the number comes from", "")


class SlideLimitPart(Part):
    """A limit state of a body that slides: one of the two."""

    slide_peak: Number | None = key("largest displacement along the ground exceeded [m]")
    slide_residual: Number | None = key("displacement along the ground in the end exceeded [m]")


SomeLimit = Annotated[
    Annotated[Number, Tag("number")] | Annotated[SlideLimitPart, Tag("mapping")],
    Discriminator(lambda value: "mapping" if isinstance(value, dict) else "number"),
]


def _intensities(value: Any) -> Any:
    names = value if isinstance(value, list) else [value]
    if not 1 <= len(names) <= 2 or not all(isinstance(name, str) and name for name in names):
        raise ValueError("the name of an intensity, or a list of two, is expected")
    return value


Intensities = Annotated[
    Any,
    BeforeValidator(_intensities),
    WithJsonSchema(
        {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 1, "maxItems": 2}]}
    ),
]


class OverPart(Part):
    """Statistics over one axis or several: what a suite of records, of samples, or of anything else, does."""

    axis: Axes = key("axis of the ensemble, by name or path; or several that stand side by side", ...)
    along: Text | None = key("axis of the intensity; default: the one amplitude of the motion that is varied")
    limits: list[SomeLimit] = key(
        "limit states: theta_peak_over_alpha exceeded [1], or {slide_peak | slide_residual: m}, beside overturning",
        [0.1, 0.5, 1],
    )
    mean: bool = key("the mean beside the fractiles; inf where any overturned", False)
    intensity: Intensities | None = key(
        "of the fragility: pga, pgv, sa(T), pgv_over_pga, arias, cav, of the ground ground_pga, ground_pgv, "
        "ground_sa(T), an axis, or a list of two of them; default: along"
    )
    fit: Literal["ordinal", "lognormal", "none"] = key(
        "one beta for all limit states, each alone, or no curve", "ordinal"
    )
    begins_at: Literal["uplift", "0"] | Literal[0] = key("where curves begin; where uplift is not known at 0", "uplift")
    beta_added: Number = key("uncertainty beside that of the suite, in quadrature [1]", 0)


Over = Annotated[OverPart | None, BeforeValidator(lambda v: {"axis": v} if isinstance(v, str | list) else v)]


class DistributionPart(Part):
    """What an uncertain input may be: one distribution, and where it is cut off."""

    normal: MeanAndSpread | None = key("[mean, standard deviation]")
    lognormal: MedianAndSpread | None = key("[median, standard deviation of the logarithm]")
    uniform: Span | None = key("[lowest, highest]")
    triangular: Triple | None = key("[lowest, most likely, highest]")
    beta: Quadruple | None = key(
        "[a, b, lowest, highest]: density proportional to (x - lowest)^(a-1) (highest - x)^(b-1)"
    )
    truncate: Pair | None = key("[from, to]: nothing outside")


class HazardPart(Part):
    """A hazard curve: annual rates at which an intensity is exceeded."""

    file: Text | None = key("CSV beside the study: intensity and annual rate, or a hazard curve exported by OpenQuake")
    intensity: Series | None = key("ascending intensities, of the fragility, in SI units or as 0.1*g")
    rate: Series | None = key("annual rates of exceedance [1/year]")
    label: Label | None = key("name of the curve; default that of the file")
    units: Text | None = key("of the intensities: g, m/s², cm/s², m/s, cm/s, g s, s; default as the file says, or SI")
    site: Site | None = key("[longitude, latitude] of a file of several sites")


class ScorePart(Part):
    """How `rock score` scores the study against experiments; its options say the same, and replace what stands here."""

    file: Text = key("CSV of the runs, beside the study: record, outcome, group, scale, other predictions", ...)
    groups: Text | None = key(
        "column of the runs that belong together: predict each by a calibration on the others", alias="folds"
    )
    calibration: Text | None = key("what `rock calibrate` wrote, beside the study")
    count: int | None = key("folds, 0 = one per group; default 5", ge=0)
    repeats: int | None = key("divisions into folds; default 5", ge=1)
    seed: int | None = key("of the folds and of the bootstrap; default 0", ge=0)
    predictions: list[Text] | None = key("columns to score; default: all that can be")
    against: Text | None = key("prediction that the others are tested against; default: the study's")
    specimen: Text | None = key("only the runs of this one")
    baselines: bool = key("whether those that know the ground motion alone are fitted", True)


def _hazards(value: Any) -> Any:
    """One curve is a list of one; a name is that of a file."""
    if value is None:
        return None
    entries = value if isinstance(value, list) else [value]
    return [{"file": entry} if isinstance(entry, str) else entry for entry in entries]


Hazards = Annotated[Annotated[list[HazardPart], Field(min_length=1)] | None, BeforeValidator(_hazards)]

NO_PLOTS = "none"

Rows = Annotated[str, Field(pattern="^[xy]([1-9][0-9]?)?$")]
"""What labels and limits are of."""


def _ends(value: Any) -> Any:
    if not isinstance(value, list) or len(value) != 2:
        raise ValueError(f"two numbers, [low, high], are expected, not {describe(value)}")
    return value


def _ascending(ends: tuple[float, float]) -> tuple[float, float]:
    low, high = ends
    if not -math.inf < low < high < math.inf:
        raise ValueError(f"two finite numbers, [low, high], low below high, are expected, not [{low:g}, {high:g}]")
    return ends


Ends = Annotated[tuple[float, float], BeforeValidator(_ends), AfterValidator(_ascending)]
"""The part of an axis of a figure that is shown."""


def _width(value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
    try:
        return handler(value)
    except ValidationError:
        raise ValueError(f"expected {WIDTHS_IN_WORDS}, not {describe(value)}") from None


class PlotPart(Part):
    """A plot, and how it is wanted."""

    kind: Literal[PLOTS] = key("kind of plot", ...)  # type: ignore[valid-type]
    select: dict[str, Any] = key("{axis: value or list of values} of the cases shown; an absent axis = every point", {})
    width: Annotated[
        Literal[tuple(WIDTHS)] | Annotated[float, Field(ge=NARROWEST, le=WIDEST)] | None,  # type: ignore[valid-type]
        WrapValidator(_width),
    ] = key("single (90 mm), double (180 mm) or a number of mm; default: as its content needs")
    title: Text | Literal[False] | None = key("title instead of the study's; false: none")
    labels: dict[Rows, str] = key("words for x and y, or for y1, y2, ..., the rows of panels from the top", {})
    limits: dict[Rows, Ends] = key("[low, high] of the same, in the units of the labels", {})
    letters: bool = key("letter the panels (a), (b), ...", False)


def _plots(value: Any) -> Any:
    """`none` is no plot; a word is a kind."""
    if value == NO_PLOTS:
        return []
    return [{"kind": one} if isinstance(one, str) else one for one in value] if isinstance(value, list) else value


Plots = Annotated[list[PlotPart] | None, BeforeValidator(_plots)]


class StudyPart(Part):
    """A study of rocking bodies."""

    name: Annotated[Label, Field(pattern=r"^[A-Za-z0-9_-]{1,100}$")] = key(
        "letters, digits, - and _; names the output folder", ...
    )
    title: Label = key("title", "")
    references: Label = key("where the study comes from", "")
    let: dict[str, Number] = key("own symbols for expressions", {})
    case: CasePart = key("the base case", ...)
    vary: dict[str, Any] = key("path inside the case -> list, range, file glob, named settings or CSV file", {})
    uncertain: dict[str, DistributionPart] = key(
        "path inside the case -> distribution; makes the dimension `sample`", {}
    )
    samples: int = key("number of samples", 200, ge=2, le=10_000_000)
    seed: int = key("of the samples: the same seed gives the same samples", 0, ge=0)
    sampling: Literal[tuple(SAMPLINGS)] = key(  # type: ignore[valid-type]
        "how samples are drawn; saltelli: blocks of Sobol points, for Sobol indices", LATIN_HYPERCUBE
    )
    compare_to: dict[str, Any] | None = key("{axis: value} of the reference")
    over: Over = key(
        "axis of the ensemble statistics, several, or {axis, along, limits, intensity, fit, ...}; default: `sample`"
    )
    hazard: Hazards = key("hazard curves that fragility is convolved with: FILE.csv or {intensity, rate}, or a list")
    age: Number | None = key("years for which the probability of exceedance, and of survival, is told")
    score: ScorePart | None = key("experiments that `rock score STUDY.yaml` holds the study against")
    refine: bool = key("trace the outcome boundary of a two-axis map instead of solving every pixel", False)
    save: SavePart = key("what is kept", SavePart.model_construct())
    plots: Plots = key("kinds of plot, or {kind, select, width, title, labels, limits, letters}; none or []: draw none")
    expect: list[ExpectPart] = key("pass/fail checks of the results", [])
    curves: list[Literal[CURVES]] = key("static curves", [])  # type: ignore[valid-type]
    rules: list[Literal[RULES]] = key("rules of thumb and code checks beside the history", [])  # type: ignore[valid-type]
    rules_spectrum: FloorSpectrumPart | None = key(
        "floor response spectrum for asce43 and asce43_sliding; default: that of the motion"
    )
    audit: Audit = key(
        "solve again at a tighter accuracy and report what disagrees: true, or the share of the cases", False
    )


_SHORTHANDS: dict[tuple[str, str], dict[str, Any]] = {
    ("CasePart", "damping"): {"enum": list(SCHEMES)},
    ("CasePart", "model"): {"enum": [*MODELS, 1, 2, 3, 4]},
    ("CasePart", "motion"): {"const": "none"},
    ("DampingPart", "spectrum"): {"const": "motion"},
    ("MotionPart", "record"): {"type": "string"},
    ("MotionPart", "vertical"): {"$ref": "#/$defs/RecordPart"},
    ("RecordPart", "taper"): NUMBER_SCHEMA,
    ("RecordPart", "highpass"): NUMBER_SCHEMA,
    ("RecordPart", "lowpass"): NUMBER_SCHEMA,
    ("RecordPart", "bandpass"): PAIR_SCHEMA,
    ("StudyPart", "hazard"): {
        "anyOf": [
            {"type": "string"},
            {"$ref": "#/$defs/HazardPart"},
            {"type": "array", "minItems": 1, "items": {"anyOf": [{"type": "string"}, {"$ref": "#/$defs/HazardPart"}]}},
        ]
    },
    ("StudyPart", "over"): {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]},
    ("StudyPart", "plots"): {
        "anyOf": [
            {"const": NO_PLOTS},
            {"type": "array", "items": {"anyOf": [{"enum": list(PLOTS)}, {"$ref": "#/$defs/PlotPart"}]}},
        ]
    },
}
"""Short forms that `shorthands.expanded` writes out before the schema sees them."""


def json_schema() -> dict[str, Any]:
    """JSON Schema of a study file, short forms included."""
    for each in Part.__subclasses__():
        each.model_rebuild()  # before 2.14 pydantic describes no default that is a part whose building is deferred
    schema = StudyPart.model_json_schema(by_alias=True)
    for (part, name), short in _SHORTHANDS.items():
        properties = (schema if part == "StudyPart" else schema["$defs"][part])["properties"]
        long = dict(properties[name])
        described = {word: long.pop(word) for word in ("description", "title") if word in long}
        long.pop("default", None)
        forms = long.pop("anyOf", None) or [long]
        properties[name] = {"anyOf": [short, *forms], **described}
    return schema
