"""Every variable of the dataset, once: name, symbol, dimension, unit, sentence.

The dataset's attributes, `rock show variables`, axis labels and the documentation come from this table.
"""

from __future__ import annotations

from dataclasses import dataclass

CASE, TIME, IMPACT = "case", "time", "impact"


@dataclass(frozen=True)
class Variable:
    """A row: `over` is CASE (the axes), TIME (axes, time) or IMPACT (axes, impact); unit "1" = dimensionless."""

    name: str
    symbol: str
    over: str
    unit: str
    sentence: str


_ROWS: tuple[Variable, ...] = (
    Variable("outcome", "outcome", CASE, "1", "what became of the body"),
    Variable(
        "theta_peak", r"$\theta_{max}$", CASE, "rad", "rotation at the earliest maximum of |theta|; +/-inf overturned"
    ),
    Variable(
        "theta_peak_over_alpha",
        r"$|\theta|_{max}/\alpha$",
        CASE,
        "1",
        "largest |theta| over alpha of that side; inf overturned",
    ),
    Variable("theta_dot_peak", r"$|\dot\theta|_{max}$", CASE, "rad s-1", "largest |rate of rotation|; inf overturned"),
    Variable(
        "u_top_peak", r"$|u_{top}|_{max}$", CASE, "m", "largest |horizontal displacement of the top|; inf overturned"
    ),
    Variable("t_peak", r"$t_{peak}$", CASE, "s", "time of theta_peak; NaN without uplift or overturned"),
    Variable("t_uplift", r"$t_{uplift}$", CASE, "s", "time rocking begins; NaN without uplift"),
    Variable(
        "t_overturn",
        r"$t_{overturn}$",
        CASE,
        "s",
        "last outward passage of the unstable equilibrium; NaN unless overturned",
    ),
    Variable("t_end", r"$t_{end}$", CASE, "s", "end of the reported response"),
    Variable("n_impacts", r"$n_{impacts}$", CASE, "1", "impacts faster than 1e-6 p alpha up to t_end"),
    Variable("mu_required", r"$\mu_{req}$", CASE, "1", "largest |T/N| at the base between impacts; inf where N <= 0"),
    Variable("mu_impact", r"$\mu_{impact}$", CASE, "1", "largest ratio of impulses at an impact"),
    Variable(
        "N_min_over_mg",
        r"$N_{min}/mg$",
        CASE,
        "1",
        "smallest normal force over the weight; <= 0: the body leaves the ground",
    ),
    Variable(
        "energy_residual",
        r"$\Delta E/E_{barrier}$",
        CASE,
        "1",
        "energy not accounted for by work and impacts, over that of the unstable equilibrium",
    ),
    Variable("error_estimate", r"$\epsilon$", CASE, "1", "estimated numerical error of theta_peak_over_alpha"),
    Variable("wall_time", "wall time", CASE, "s", "time the solver took, shared evenly over a batch"),
    Variable("n_steps", r"$n_{steps}$", CASE, "1", "steps of the solver"),
    Variable("reason", "reason", CASE, "1", "index into `reasons`: what there is to say about this case"),
    Variable("R", r"$R$", CASE, "m", "distance from the edge to the centre of mass (the edge with the smaller alpha)"),
    Variable("alpha", r"$\alpha$", CASE, "rad", "slenderness angle (the smaller of both edges)"),
    Variable("p", r"$p$", CASE, "rad s-1", "frequency parameter sqrt(m g R/I_O) (the edge with the smaller alpha)"),
    Variable(
        "eta",
        r"$\eta$",
        CASE,
        "1",
        "angular velocity after / before an impact (landing on the edge with the smaller alpha)",
    ),
    Variable("a_p", r"$a_p$", CASE, "m s-2", "pulse amplitude"),
    Variable("omega_p", r"$\omega_p$", CASE, "rad s-1", "circular frequency of the pulse"),
    Variable("pga", "PGA", CASE, "m s-2", "peak ground acceleration of the motion used"),
    Variable("pgv", "PGV", CASE, "m s-1", "peak ground velocity of the motion used"),
    Variable("theta", r"$\theta$", TIME, "rad", "rotation"),
    Variable("theta_dot", r"$\dot\theta$", TIME, "rad s-1", "rate of rotation"),
    Variable("a_g", r"$a_g$", TIME, "m s-2", "horizontal ground acceleration"),
    Variable("a_v", r"$a_v$", TIME, "m s-2", "vertical ground acceleration, positive up"),
    Variable(
        "u_top", r"$u_{top}$", TIME, "m", "horizontal displacement of the pivot-side top corner relative to the ground"
    ),
    Variable("v_top", r"$v_{top}$", TIME, "m", "vertical displacement of the pivot-side top corner"),
    Variable(
        "M_base",
        r"$M_{base}$",
        TIME,
        "m2 s-2",
        "moment of the base on the body, opposing theta; per unit mass unless the study gives a mass (then N m)",
    ),
    Variable("t_impact", r"$t$", IMPACT, "s", "time of impact"),
    Variable("theta_dot_before", r"$\dot\theta^-$", IMPACT, "rad s-1", "rate of rotation just before"),
    Variable("theta_dot_after", r"$\dot\theta^+$", IMPACT, "rad s-1", "rate of rotation just after"),
    Variable(
        "error_theta_peak_over_alpha",
        r"$\Delta|\theta|_{max}/\alpha$",
        CASE,
        "1",
        "theta_peak_over_alpha minus the reference's",
    ),
    Variable(
        "error_history",
        r"$\sup|\Delta\theta|/\alpha$",
        CASE,
        "1",
        "largest |theta - theta_ref|/alpha before either overturns",
    ),
    Variable("same_outcome", "same outcome", CASE, "1", "1 where the outcome agrees with the reference's"),
)

VARIABLES: dict[str, Variable] = {row.name: row for row in _ROWS}

SCALARS: tuple[str, ...] = (
    "outcome", "theta_peak", "theta_peak_over_alpha", "theta_dot_peak", "u_top_peak", "t_peak", "t_uplift", "t_overturn",
    "t_end", "n_impacts", "mu_required", "mu_impact", "N_min_over_mg", "energy_residual", "error_estimate", "wall_time",
    "n_steps", "reason",
)  # fmt: skip
"""Scalars a study can save, in the order of the contract."""

SCALARS_LARGE: tuple[str, ...] = ("outcome", "theta_peak_over_alpha", "n_impacts")
"""Scalars saved by default above LARGE cases."""

LARGE = 100_000
"""Cases above which only SCALARS_LARGE are saved by default."""

HISTORIES: tuple[str, ...] = tuple(v.name for v in _ROWS if v.over == TIME)
IMPACTS: tuple[str, ...] = tuple(v.name for v in _ROWS if v.over == IMPACT)
