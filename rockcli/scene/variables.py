"""Every variable of the dataset, once: name, symbol, dimension, unit, sentence.

The dataset's attributes, `rock show variables`, axis labels and the documentation come from this table.
"""

from __future__ import annotations

from dataclasses import dataclass

from rockcli.scene.rules import RULES

CASE, TIME, IMPACT, ROTATION = "case", "time", "impact", "rotation"
SUITE, LIMIT, MEASURE, PERCENTILE, INPUT = "suite", "limit_state", "measure", "percentile", "input"
HAZARD, HAZARD_POINT, INTENSITY_BIN = "hazard", "hazard_point", "intensity_bin"
SETTING = "setting"
OUTLINE = "outline_point"
BOUNDARY_POINT = "boundary_point"
AZIMUTH = "azimuth"

DIMENSIONS: dict[str, str] = {
    CASE: "axes",
    TIME: "axes, time",
    IMPACT: "axes, impact",
    ROTATION: "axes, rotation",
    SUITE: "axes left by over",
    LIMIT: "axes left by over, limit_state",
    MEASURE: "axes left by over, measure",
    PERCENTILE: "axes left by over, limit_state, percentile",
    INPUT: "axes left by over, input",
    HAZARD: "axes left by over, limit_state, hazard",
    INTENSITY_BIN: "axes left by over, limit_state, hazard, intensity_bin",
    HAZARD_POINT: "hazard, hazard_point",
    SETTING: "setting",
    OUTLINE: "axes that change the body, outline_point",
    BOUNDARY_POINT: "boundary_point",
    AZIMUTH: "axes that change the mesh, azimuth",
}
"""What a variable extends over, and the dimensions that come to."""

PEAK = "theta_peak_over_alpha"
"""The peak that figures, suites and comparisons speak of."""

SLIDE = "slide_peak"
"""That of bodies that slide."""

MOTION = "ground_motion"
"""Which motion of the ground a case has."""

OF_SOURCE = ("magnitude", "r_rup", "r_jb", "vs30", "pulse_period")
"""What is known of the earthquake and the site of a record, where the file or its database says it."""

YEARLY = "year-1"

UNIT_OF_INTENSITY, UNIT_OF_SECOND = "of the intensity", "of the second intensity"
"""Units that a suite decides on: of what its fragility is told against."""

PERCENTILES: tuple[float, ...] = (1.0, 5.0, 10.0, 16.0, 50.0, 84.0, 95.0)
"""Percentiles of a fragility curve that are told [%]."""

COUNTS = ("n_impacts", "n_steps", "n_rhs")
"""Scalars that are whole numbers."""


@dataclass(frozen=True)
class Variable:
    """A row: `over` is a key of `DIMENSIONS`; unit "1" = dimensionless, `UNIT_OF_INTENSITY` = in a dataset that of it."""

    name: str
    symbol: str
    over: str
    unit: str
    sentence: str


_FRACTILES = (("p16", "16th percentile"), ("p50", "median"), ("p84", "84th percentile"), ("mean", "mean"))

# fmt: off
_SUITE_ROWS: tuple[Variable, ...] = (
    Variable("n_answered", r"$n$", SUITE, "1", "members of the suite with an answer, also if only a share of their perturbed runs overturns"),
    Variable("p_overturned", r"$P_{\mathrm{overturned}}$", SUITE, "1", "share of the members with an answer that overturned, each by its overturn_share"),
    Variable("p_overturned_low", r"$P_{\mathrm{overturned}}$", SUITE, "1", "the same if all without an answer remain stable"),
    Variable("p_overturned_high", r"$P_{\mathrm{overturned}}$", SUITE, "1", "the same if all without an answer overturn"),
    Variable("p_overturned_se", r"$s_P$", SUITE, "1", "standard error of p_overturned over samples, at most that of as many independent samples"),
    Variable("p_overturned_ci_low", r"$P$", SUITE, "1", "lower 95 % confidence limit of p_overturned over samples"),
    Variable("p_overturned_ci_high", r"$P$", SUITE, "1", "upper 95 % confidence limit of p_overturned over samples"),
    Variable("input", "input", INPUT, "1", "uncertain input"),
    Variable("input_spearman", r"$\rho_S$", INPUT, "1", "rank correlation of theta_peak_over_alpha and the input; overturned counts as largest"),
    *(
        Variable(
            f"sobol_{order}{error}{of}", symbol, INPUT, "1", f"{before}{words} Sobol index of the input, {meaning}"
        )
        for of, meaning in (
            ("", "for whether the body overturns"),
            ("_peak", "for theta_peak_over_alpha; NaN where any sample overturns"),
        )
        for order, symbol, words in (("first", r"$S_i$", "first-order"), ("total", r"$S_{Ti}$", "total"))
        for error, before in (("", ""), ("_se", "standard error of the "))
    ),
    *(
        Variable(f"{name}_{end}", f"{symbol}, {words}", SUITE, unit, f"{words} of {name} over the suite; {inf}")
        for name, symbol, unit in (
            ("theta_peak_over_alpha", r"$|\theta|_{\mathrm{max}}/\alpha$", "1"),
            ("theta_dot_peak", r"$|\dot\theta|_{\mathrm{max}}$", "rad s-1"),
            ("u_top_peak", r"$|u_{\mathrm{top}}|_{\mathrm{max}}$", "m"),
            ("slide_peak", r"$|u|_{\mathrm{max}}$", "m"),
        )
        for end, words in _FRACTILES
        for inf in ("inf where any overturned" if end == "mean" else "overturned counts as inf",)
    ),
    Variable("safe_island", "stable island", CASE, "1", "stable island: 1 where a case remains stable although a lower intensity overturned it"),
    Variable("n_safe_islands", r"$n_{\mathrm{islands}}$", SUITE, "1", "members that remain stable above an overturning intensity (stable islands)"),
    Variable("limit_state", "limit state", LIMIT, "1", "theta_peak_over_alpha (or the slide named) exceeded, or overturned"),
    Variable("p_exceeded", r"$P$", LIMIT, "1", "share of the members with an answer that exceed the limit state"),
    Variable("fragility_median", r"$\hat\theta$", LIMIT, UNIT_OF_INTENSITY, "intensity exceeded with probability 1/2; NaN: no curve"),
    Variable("fragility_median_low", r"$\hat\theta$", LIMIT, UNIT_OF_INTENSITY, "the same if all without an answer exceed it"),
    Variable("fragility_median_high", r"$\hat\theta$", LIMIT, UNIT_OF_INTENSITY, "the same if none without an answer exceeds it"),
    Variable("fragility_median_ci_low", r"$\hat\theta$", LIMIT, UNIT_OF_INTENSITY, "lower 95 % confidence limit of fragility_median"),
    Variable("fragility_median_ci_high", r"$\hat\theta$", LIMIT, UNIT_OF_INTENSITY, "upper 95 % confidence limit of fragility_median"),
    Variable("fragility_intensity", r"$x$", CASE, UNIT_OF_INTENSITY, "intensity of the fragility curves, where it is no axis"),
    Variable("fragility_intensity_second", r"$y$", CASE, UNIT_OF_SECOND, "second intensity of the fragility curves"),
    Variable("fragility_second", r"$y_r$", SUITE, UNIT_OF_SECOND, "second intensity y_r at which medians and percentiles are given"),
    Variable("fragility_exponent", r"$c$", LIMIT, "1", "c: median - x_0 is proportional to (y/y_r)^-c, y the second intensity, y_r = fragility_second"),
    Variable("fragility_exponent_ci_low", r"$c$", LIMIT, "1", "lower 95 % confidence limit of fragility_exponent"),
    Variable("fragility_exponent_ci_high", r"$c$", LIMIT, "1", "upper 95 % confidence limit of fragility_exponent"),
    Variable("fragility_begins_at", r"$x_0$", SUITE, UNIT_OF_INTENSITY, "intensity x_0; the fragility curve is zero at and below it"),
    Variable("fragility_begins_at_last", r"$x$", SUITE, UNIT_OF_INTENSITY, "intensity from which every member can move (0: not known)"),
    Variable("fragility_lowest", r"$x$", SUITE, UNIT_OF_INTENSITY, "lowest intensity of the suite; percentiles below it are extrapolated"),
    Variable("fragility_highest", r"$x$", SUITE, UNIT_OF_INTENSITY, "highest intensity of the suite; percentiles above it are extrapolated"),
    Variable("fragility_misfit_p", r"$P$", LIMIT, "1", "bound on the probability that a share lies as far from the curve as the farthest one (binomial, Bonferroni)"),
    Variable("fragility_misfit_at", r"$x$", LIMIT, UNIT_OF_INTENSITY, "intensity of the share that is farthest from the curve"),
    Variable("fragility_beta", r"$\beta$", LIMIT, "1", "standard deviation of ln(x - x_0), x_0 = fragility_begins_at"),
    Variable("fragility_beta_ci_low", r"$\beta$", LIMIT, "1", "lower 95 % confidence limit of fragility_beta"),
    Variable("fragility_beta_ci_high", r"$\beta$", LIMIT, "1", "upper 95 % confidence limit of fragility_beta"),
    Variable("fragility_beta_total", r"$\beta$", LIMIT, "1", "fragility_beta and beta_added in quadrature"),
    Variable("fragility_se_ln_median", r"$s$", LIMIT, "1", "standard error of ln(fragility_median - x_0), clustered by member"),
    Variable("fragility_se_beta", r"$s_\beta$", LIMIT, "1", "standard error of fragility_beta, clustered by member"),
    Variable("fragility_correlation", r"$\rho$", LIMIT, "1", "correlation of the estimates of ln(median - x_0) and beta"),
    Variable("fragility_percentile", r"$x_p$", PERCENTILE, UNIT_OF_INTENSITY, "intensity exceeded with a probability, by fragility_beta_total"),
    *(
        Variable(
            f"fragility_percentile_ci_{end}",
            r"$x_p$",
            PERCENTILE,
            UNIT_OF_INTENSITY,
            f"{word} 95 % confidence limit of fragility_percentile",
        )
        for end, word in (("low", "lower"), ("high", "upper"))
    ),
    Variable("hazard", "hazard curve", HAZARD, "1", "hazard curve that fragility is convolved with"),
    Variable("hazard_intensity", r"$x$", HAZARD_POINT, UNIT_OF_INTENSITY, "intensity at the points of a hazard curve"),
    Variable("hazard_rate", r"$H$", HAZARD_POINT, YEARLY, "annual rate at which the intensity is exceeded"),
    Variable("annual_rate", r"$\lambda$", HAZARD, YEARLY, "annual rate at which the limit state is exceeded; motions beyond the end of the hazard curve count as if at its end"),
    Variable("annual_rate_ci_low", r"$\lambda$", HAZARD, YEARLY, "lower 95 % limit of annual_rate by the suite's scatter"),
    Variable("annual_rate_ci_high", r"$\lambda$", HAZARD, YEARLY, "upper 95 % limit of annual_rate by the suite's scatter"),
    Variable("annual_rate_above", r"$\lambda$", HAZARD, YEARLY, "upper bound of what motions beyond the end of the hazard curve add to annual_rate"),
    Variable("annual_rate_below", r"$\lambda$", HAZARD, YEARLY, "what motions below the first point of the hazard curve would add if its first power law continued to zero"),
    Variable("probability_in_age", r"$P$", HAZARD, "1", "probability that the limit state is exceeded within the age"),
    Variable("survival", r"$S$", HAZARD, "1", "probability that the limit state is never exceeded within the age"),
    Variable("likelihood_ratio", r"$\Lambda$", HAZARD, "1", "survival over the largest survival of all hazard curves"),
    Variable("hazard_consistent", "consistent", HAZARD, "1", "1 where survival is at least 5 %"),
    Variable("intensity_bin", r"$x$", INTENSITY_BIN, UNIT_OF_INTENSITY, "geometric mean of the ends of a bin of intensity"),
    Variable("intensity_bin_low", r"$x$", INTENSITY_BIN, UNIT_OF_INTENSITY, "lower end of a bin of intensity"),
    Variable("intensity_bin_high", r"$x$", INTENSITY_BIN, UNIT_OF_INTENSITY, "upper end of a bin of intensity"),
    Variable("deaggregation", "share of the rate", INTENSITY_BIN, "1", "share of annual_rate from motions in a bin; motions beyond the end of the hazard curve are in its last bin"),
    Variable("percentile", "percentile", PERCENTILE, "%", "probability that the limit state is exceeded"),
    Variable("fragility_status", "status", LIMIT, "1", "whether there is a fragility curve, or why not"),
    Variable("measure", "measure", MEASURE, "1", "measure of the ground motion"),
    Variable("demand_spearman", r"$\rho_S$", MEASURE, "1", "rank correlation of theta_peak_over_alpha and the measure"),
    Variable("demand_pearson", r"$\rho_P$", MEASURE, "1", "correlation of the logarithms, of members that rock and remain stable"),
    Variable("n_moving", r"$n_{\mathrm{rock}}$", SUITE, "1", "members that rock and remain stable"),
    Variable("p_pgv_over_g_tan_alpha", r"$p\,\mathrm{PGV}/(g\,\tan\alpha)$", CASE, "1", "dimensionless peak velocity"),
    Variable("arias", r"$I_A$", CASE, "m s-1", "Arias intensity of the record used"),
    Variable("cav", "CAV", CASE, "m s-1", "cumulative absolute velocity of the record used"),
    Variable("t_mean", r"$T_m$", CASE, "s", "mean period of the record used (Rathje et al. 1998)"),
    Variable("d5_95", r"$D_{5-95}$", CASE, "s", "significant duration of the record used, 5-95 % of Arias intensity"),
)
# fmt: on
"""What statistics of suites (`over`) add."""

MEASURES: tuple[str, ...] = ("pga", "pgv", "p_pgv_over_g_tan_alpha", "arias", "cav", "t_mean", "d5_95")
"""Measures of the ground motion that a suite's response is compared with."""

# fmt: off
_ROWS: tuple[Variable, ...] = (
    Variable("outcome", "outcome", CASE, "1", "outcome: overturned after an impact is mode 1, without impact mode 2 of Zhang and Makris (2001)"),
    Variable("theta_peak", r"$\theta_{\mathrm{max}}$", CASE, "rad", "rotation at the earliest maximum of |theta|; +/-inf if it overturns"),
    Variable("theta_peak_over_alpha", r"$|\theta|_{\mathrm{max}}/\alpha$", CASE, "1", "largest |theta|/alpha, each side by its own alpha; inf overturned"),
    Variable("theta_dot_peak", r"$|\dot\theta|_{\mathrm{max}}$", CASE, "rad s-1", "largest |angular velocity|; inf overturned"),
    Variable("u_top_peak", r"$|u_{\mathrm{top}}|_{\mathrm{max}}$", CASE, "m", "largest |horizontal displacement of the top|; inf overturned"),
    Variable("t_peak", r"$t_{\mathrm{peak}}$", CASE, "s", "time of theta_peak; NaN without uplift or overturned"),
    Variable("t_uplift", r"$t_{\mathrm{uplift}}$", CASE, "s", "time rocking begins; NaN without uplift"),
    Variable("t_overturn", r"$t_{\mathrm{overturn}}$", CASE, "s", "last outward passage of the unstable equilibrium; NaN unless overturned"),
    Variable("t_end", r"$t_{\mathrm{end}}$", CASE, "s", "end of the reported response"),
    Variable("n_impacts", r"$n_{\mathrm{impacts}}$", CASE, "1", "impacts up to t_end that are faster than 1e-6 p alpha, p and alpha of the edge the body turned about before; for a body that rolls alpha is the nearer rotation at which it falls"),
    Variable("mu_required", r"$\mu_{\mathrm{req}}$", CASE, "1", "largest |T/N| at the base between impacts (if the body overturns, up to its last outward passage of the equilibrium); mu for a body that slides; inf where N <= 0"),
    Variable("mu_impact", r"$\mu_{\mathrm{impact}}$", CASE, "1", "largest ratio of impulses at an impact"),
    Variable("N_min_over_mg", r"$N_{\mathrm{min}}/mg$", CASE, "1", "smallest normal force over the weight (if the body overturns, up to its last outward passage of the equilibrium); <= 0: the body leaves the ground"),
    Variable("energy_residual", r"$\Delta E/E_{\mathrm{barrier}}$", CASE, "1", "energy not accounted for by work and impacts, over the energy of the unstable equilibrium"),
    Variable("landing_loss", r"$E_{\mathrm{land}}/E_{\mathrm{barrier}}$", CASE, "1", "energy a captured base lost at impacts of a flexible body, over the energy of the unstable equilibrium"),
    Variable("slide_peak", r"$|u|_{\mathrm{max}}$", CASE, "m", "largest |displacement along the ground| (if the body overturns, up to its last outward passage of the equilibrium); NaN without mu, inf where no friction stops it"),
    Variable("slide_residual", r"$u_{\mathrm{res}}$", CASE, "m", "displacement along the ground at the end; NaN without mu or if the body overturns, inf or -inf where no friction stops it"),
    Variable("residual_tilt", r"$\theta_{\mathrm{res}}$", CASE, "rad", "rotation in which the body comes to rest (the facet it ends on, if it rolls over several vertices); NaN if it overturns, or if nothing brings it to rest"),
    Variable("n_slips", r"$n_{\mathrm{slips}}$", CASE, "1", "how often the base begins to slip; NaN without mu"),
    Variable("n_flights", r"$n_{\mathrm{flights}}$", CASE, "1", "how often the body leaves the ground; NaN without mu"),
    Variable("n_jams", r"$n_{\mathrm{jams}}$", CASE, "1", "how often no finite force lets the body slide on (jamming); NaN without mu"),
    Variable("t_slip", r"$t_{\mathrm{slip}}$", CASE, "s", "when the base first slips; NaN if it does not"),
    Variable("t_flight", r"$t_{\mathrm{flight}}$", CASE, "s", "when the body first leaves the ground; NaN if it does not"),
    Variable("error_estimate", r"$\epsilon$", CASE, "1", "estimated numerical error of theta_peak_over_alpha"),
    Variable("overturn_share", "share overturned", CASE, "1", "0 or 1 where the outcome is certain; else the share of runs, perturbed within the tolerance, that overturn"),
    Variable("wall_time", "wall time", CASE, "s", "time the solver took, shared evenly over a batch"),
    Variable("model_used", "model", CASE, "1", "model auto: the model that solved the case"),
    Variable("model_error", r"$\epsilon_{\mathrm{model}}$", CASE, "1", "model auto: expected error of theta_peak_over_alpha against the highest model; NaN where the highest model was used, or the body overturns"),
    Variable("n_steps", r"$n_{\mathrm{steps}}$", CASE, "1", "steps of the solver"),
    Variable("n_rhs", r"$n_{\mathrm{rhs}}$", CASE, "1", "evaluations of the right-hand side (docs/trade.md)"),
    Variable("reason", "reason", CASE, "1", "index into `reasons`: the message about this case"),
    Variable("fema_delta", r"$\delta_{\mathrm{FEMA}}$", CASE, "m", "fema356: displacement of the centre of mass; inf overturned"),
    Variable("fema_u_top", r"$u_{\mathrm{FEMA}}$", CASE, "m", "fema356: displacement of the top; inf overturned"),
    Variable("fema_T", r"$T_{\mathrm{FEMA}}$", CASE, "s", "fema356: period at the solution"),
    Variable("fema_beta", r"$\beta_{\mathrm{FEMA}}$", CASE, "1", "fema356: effective damping ratio"),
    Variable("fema_n_roots", r"$n_{\mathrm{roots}}$", CASE, "1", "fema356: number of amplitudes that solve it; 0: overturning predicted"),
    *(
        Variable(
            f"outline_{axis}",
            rf"${axis}$",
            OUTLINE,
            "m",
            f"outline of the body, from {origin}; NaN between polygons and after the last",
        )
        for axis, origin in (("x", "the centre of mass"), ("z", "the base"))
    ),
    Variable(AZIMUTH, r"$\varphi$", AZIMUTH, "rad", "direction in the axes of a mesh, from x towards y"),
    Variable("barrier", r"$\Delta h$", AZIMUTH, "m", "largest rise of the centre of mass on the way to a quarter turn, by the direction in which the body is tipped"),
    Variable("rocks_towards", r"$\varphi$", CASE, "rad", "direction in which the body of a mesh rocks, theta > 0, from x towards y of the mesh"),
    Variable("barrier_towards", r"$\Delta h$", CASE, "m", "the barrier of the body of a mesh in the direction in which it rocks, theta > 0"),
    Variable("R", r"$R$", CASE, "m", "distance from the edge to the centre of mass (the edge with the smaller alpha)"),
    Variable("alpha", r"$\alpha$", CASE, "rad", "slenderness angle (the smaller of both edges)"),
    Variable("p", r"$p$", CASE, "rad s-1", "frequency parameter sqrt(m g R/I_O) (the edge with the smaller alpha)"),
    Variable("eta", r"$\eta$", CASE, "1", "coefficient of restitution: angular velocity after / before an impact (on the edge with the smaller alpha)"),
    *(
        Variable(f"{name}_{side}", symbol, CASE, unit, f"asymmetric bodies: {sentence} the {side} edge")
        for name, symbol, unit, sentence in (
            ("R", r"$R$", "m", "distance to the centre of mass from"),
            ("alpha", r"$\alpha$", "rad", "slenderness angle of"),
            ("p", r"$p$", "rad s-1", "frequency parameter about"),
            ("eta", r"$\eta$", "1", "angular velocity after / before an impact on"),
            ("theta_peak", r"$|\theta|_{\mathrm{max}}$", "rad", "largest |theta| (inf overturned) about"),
        )
        for side in ("left", "right")
    ),
    Variable("pga_uplift", r"PGA$_{\mathrm{uplift}}$", CASE, "m s-2", "asymmetric bodies: the PGA above which the scaled motion lifts the body, about the edge that lifts first"),
    Variable("g", r"$g$", CASE, "m s-2", "acceleration of gravity"),
    Variable("uplift_factor", r"$W/(M\,g)$", CASE, "1", "FEMA-356: uplift PGA over g tan(alpha); NaN where a spectrum decides"),
    Variable("a_p", r"$a_p$", CASE, "m s-2", "pulse amplitude"),
    Variable("omega_p", r"$\omega_p$", CASE, "rad s-1", "circular frequency of the pulse"),
    Variable("pga", "PGA", CASE, "m s-2", "peak ground acceleration of the motion used"),
    Variable("pgv", "PGV", CASE, "m s-1", "peak ground velocity of the motion used"),
    Variable("magnitude", r"$M$", CASE, "1", "magnitude of the earthquake, as the record or its database says"),
    Variable("r_rup", r"$R_{\mathrm{rup}}$", CASE, "km", "closest distance to the rupture, as the record or its database says"),
    Variable("r_jb", r"$R_{\mathrm{JB}}$", CASE, "km", "distance of Joyner and Boore, as the record or its database says"),
    Variable("vs30", r"$V_{S30}$", CASE, "m s-1", "shear-wave velocity of the site, as the record or its database says"),
    Variable("pulse_period", r"$T_{\mathrm{pulse}}$", CASE, "s", "period of the velocity pulse, as its database says"),
    Variable(MOTION, "motion", CASE, "1", "number of the ground motion; cases with the same number have the same motion, apart from its scale"),
    Variable("theta", r"$\theta$", TIME, "rad", "rotation"),
    Variable("theta_dot", r"$\dot\theta$", TIME, "rad s-1", "angular velocity"),
    Variable("a_g", r"$a_g$", TIME, "m s-2", "horizontal ground acceleration"),
    Variable("a_v", r"$a_v$", TIME, "m s-2", "vertical ground acceleration, positive up"),
    Variable("u_top", r"$u_{\mathrm{top}}$", TIME, "m", "horizontal displacement of the pivot-side top corner relative to the ground"),
    Variable("u_top_bending", r"$u_{\mathrm{bend}}$", TIME, "m", "flexible body: displacement of the top due to bending, u_top minus 2h sin(theta)"),
    Variable("v_top", r"$v_{\mathrm{top}}$", TIME, "m", "vertical displacement of the pivot-side top corner"),
    Variable("M_base", r"$M_{\mathrm{base}}$", TIME, "m2 s-2", "moment of the base on the body, opposing theta; per unit mass unless the study gives a mass (then N m)"),
    Variable("slide", r"$u$", TIME, "m", "displacement of the base along the ground, where mu is given"),
    Variable("slide_dot", r"$\dot u$", TIME, "m s-1", "velocity of sliding along the ground, where mu is given"),
    Variable("lift", "lift", TIME, "m", "height of the lower edge, 0 unless the body flies, where mu is given"),
    Variable("contact_mode", "contact", TIME, "1", "mode of contact, where mu is given"),
    Variable("t_impact", r"$t$", IMPACT, "s", "time of impact"),
    Variable("theta_dot_before", r"$\dot\theta^-$", IMPACT, "rad s-1", "angular velocity just before"),
    Variable("theta_dot_after", r"$\dot\theta^+$", IMPACT, "rad s-1", "angular velocity just after"),
    Variable("error_theta_peak_over_alpha", r"$\Delta|\theta|_{\mathrm{max}}/\alpha$", CASE, "1", "theta_peak_over_alpha minus that of the reference"),
    Variable("error_history", r"$\sup|\Delta\theta|/\alpha$", CASE, "1", "largest |theta - theta_ref|/alpha before either overturns"),
    Variable("same_outcome", "same outcome", CASE, "1", "1 where the outcome agrees with that of the reference"),
    Variable("boundary", "boundary", BOUNDARY_POINT, "1", "refine: what changes at a curve; its points are boundary_<axis>, for every axis"),
    Variable("boundary_curve", "curve", BOUNDARY_POINT, "1", "refine: number of the curve a point belongs to"),
    Variable("solved", "solved", CASE, "1", "refine: 1 solved; 0 filled in, with the outcome of the points around it"),
    Variable("audit_same_outcome", "same outcome", CASE, "1", "1 where a tighter run gave the same outcome, 0 where it gave another"),
    Variable("audit_error", r"$\Delta|\theta|_{\mathrm{max}}/\alpha$", CASE, "1", "|peak - peak of a tighter run|"),
    Variable("audit_disagreements", "disagreements", CASE, "1", "outcomes and peaks a tighter run does not confirm"),
    Variable("cost", "cost per case", SETTING, "s", "time per case of the sample, in one process"),
    Variable("error_median", r"median $|\epsilon|$", SETTING, "1", "median of |error_theta_peak_over_alpha|"),
    Variable("error_p90", r"90 % $|\epsilon|$", SETTING, "1", "90th percentile of |error_theta_peak_over_alpha|"),
    Variable("wrong_outcomes", "wrong outcomes", SETTING, "1", "share of the outcomes that differ"),
    Variable("on_front", "Pareto front", SETTING, "1", "1 where no other setting is cheaper and more accurate"),
    Variable("angle_worst", r"$\varphi_{\mathrm{w}}$", CASE, "rad", "direction of the motion with the largest peak"),
    Variable("theta_peak_over_alpha_worst", r"$|\theta|_{\mathrm{max}}/\alpha$", CASE, "1", "theta_peak_over_alpha in the worst direction; inf overturned"),
    Variable("theta_over_alpha", r"$\theta/\alpha$", ROTATION, "1", "rotation over alpha, of the static curves"),
    Variable("energy_ratio", "energy retained per cycle", ROTATION, "1", "energy after one cycle of free rocking over energy before, by amplitude; linearized for a dashpot (3.1), (3.3)"),
    Variable("energy_ratio_block", r"$\eta^4$", ROTATION, "1", "the same for Housner's eta at each of two impacts (3.1)"),
    Variable("restoring_moment", r"$M_r/(mgR)$", ROTATION, "1", "restoring moment of the model over m g R"),
    Variable("restoring_moment_block", r"$M_r/(mgR)$", ROTATION, "1", "restoring moment of the block over m g R"),
    Variable("spring_moment", r"$M_s/(mgR)$", ROTATION, "1", "moment of the model's base spring over m g R; NaN without one"),
    Variable("pushover_force", r"$F/(mg)$", ROTATION, "1", "horizontal force at the centroid over m g, model"),
    Variable("pushover_force_block", r"$F/(mg)$", ROTATION, "1", "horizontal force at the centroid over m g, block"),
    Variable("u_model", r"$u$", ROTATION, "m", "horizontal displacement of the model's top"),
    Variable("v_model", r"$v$", ROTATION, "m", "vertical displacement of the model's top"),
    Variable("u_pivot_corner", r"$u$", ROTATION, "m", "horizontal displacement of the block's top corner above the pivot"),
    Variable("v_pivot_corner", r"$v$", ROTATION, "m", "vertical displacement of the block's top corner above the pivot"),
    Variable("u_free_corner", r"$u$", ROTATION, "m", "horizontal displacement of the block's other top corner"),
    Variable("v_free_corner", r"$v$", ROTATION, "m", "vertical displacement of the block's other top corner"),
    Variable("overturning_moment", r"$M_o/(ma_gR)$", ROTATION, "1", "overturning moment of the model over m a_g R"),
    Variable("overturning_moment_block", r"$M_o/(ma_gR)$", ROTATION, "1", "overturning moment of the block over m a_g R"),
    Variable("theta_critical_over_alpha", r"$\theta_{cr}/\alpha$", CASE, "1", "rotation at which the model's restoring moment vanishes, over alpha; inf: never"),
    Variable("curve_error_moment_rotation", r"$\epsilon_M$", CASE, "1", "largest |model - block| of the restoring moment over the block's at 0"),
    Variable("curve_error_pushover", r"$\epsilon_F$", CASE, "1", "largest |model - block| of the pushover force over the block's at 0"),
    Variable("curve_error_displacements", r"$\epsilon_u$", CASE, "1", "largest |model - block's free corner| of u over that corner's u at alpha"),
    Variable("curve_error_displacements_vertical", r"$\epsilon_v$", CASE, "1", "largest |model - block's free corner| of v over that corner's u at alpha"),
    Variable("curve_error_overturning_moment", r"$\epsilon_{M_o}$", CASE, "1", "largest |model - block| of the overturning moment over the block's at 0"),
    *(Variable(rule.variable, rule.symbol, CASE, rule.unit, rule.meaning) for rule in RULES.values()),
)
# fmt: on

VARIABLES: dict[str, Variable] = {row.name: row for row in (*_ROWS, *_SUITE_ROWS)}

AUDIT: tuple[str, ...] = ("audit_same_outcome", "audit_error", "audit_disagreements")
"""What an audit adds to a dataset."""

SCALARS_FLEXIBLE: tuple[str, ...] = ("landing_loss",)
"""Scalars of the flexible model alone."""

SCALARS_ASYMMETRIC: tuple[str, ...] = ("theta_peak_left", "theta_peak_right")
"""What only bodies of two different edges have."""

SCALARS_ROLLING: tuple[str, ...] = ("residual_tilt",)
"""What only bodies that roll over several vertices find out; it follows for all others."""

SCALARS_SLIDING: tuple[str, ...] = (
    "slide_peak", "slide_residual", "n_slips", "n_flights", "n_jams", "t_slip", "t_flight",
)  # fmt: skip
"""What only cases with a coefficient of friction have."""

SCALARS_FEMA: tuple[str, ...] = ("fema_delta", "fema_u_top", "fema_T", "fema_beta", "fema_n_roots")
"""What only the damping scheme fema356 knows; NaN for all others."""

SCALARS_AUTO: tuple[str, ...] = ("model_used", "model_error")
"""What only model auto has to say."""

SCALARS: tuple[str, ...] = (
    "outcome", "theta_peak", "theta_peak_over_alpha", "theta_dot_peak", "u_top_peak", "t_peak", "t_uplift", "t_overturn",
    "t_end", "n_impacts", "mu_required", "mu_impact", "N_min_over_mg", "energy_residual", "error_estimate", "overturn_share",
    "wall_time", "n_steps", "n_rhs", "reason", *SCALARS_FLEXIBLE, *SCALARS_FEMA, *SCALARS_SLIDING, *SCALARS_ASYMMETRIC, *SCALARS_AUTO, *SCALARS_ROLLING,
)  # fmt: skip
"""Scalars a study can save, in the order of the contract."""

SCALARS_LARGE: tuple[str, ...] = ("outcome", "theta_peak_over_alpha", "n_impacts")
"""Scalars saved by default above LARGE cases."""

LARGE = 100_000
"""Cases above which only SCALARS_LARGE are saved by default."""

GROUND: tuple[str, ...] = ("a_g", "a_v")
"""Histories that follow from the motion alone."""

HISTORIES: tuple[str, ...] = tuple(v.name for v in _ROWS if v.over == TIME)
IMPACTS: tuple[str, ...] = tuple(v.name for v in _ROWS if v.over == IMPACT)
