"""The variables that statistics of suites add to the dataset (`over`); read with all others from `variables`."""

from __future__ import annotations

from rockcli.scene.variable import CASE, LIMIT, MEASURE, SUITE, Variable

_FRACTILES = (("p16", "16 % fractile"), ("p50", "median"), ("p84", "84 % fractile"), ("mean", "mean"))

SUITE_ROWS: tuple[Variable, ...] = (
    Variable(
        "n_answered",
        r"$n$",
        SUITE,
        "1",
        "members of the suite with an answer, be it that they overturn in a part of their runs",
    ),
    Variable(
        "p_overturned",
        r"$P_{\mathrm{overturned}}$",
        SUITE,
        "1",
        "share that overturned of those with an answer, each by its share",
    ),
    Variable("p_overturned_low", r"$P_{\mathrm{overturned}}$", SUITE, "1", "the same if all without an answer stand"),
    Variable(
        "p_overturned_high", r"$P_{\mathrm{overturned}}$", SUITE, "1", "the same if all without an answer overturn"
    ),
    *(
        Variable(f"{name}_{end}", f"{symbol}, {words}", SUITE, unit, f"{words} of {name} over the suite; {inf}")
        for name, symbol, unit in (
            ("theta_peak_over_alpha", r"$|\theta|_{\mathrm{max}}/\alpha$", "1"),
            ("theta_dot_peak", r"$|\dot\theta|_{\mathrm{max}}$", "rad s-1"),
            ("u_top_peak", r"$|u_{\mathrm{top}}|_{\mathrm{max}}$", "m"),
        )
        for end, words in _FRACTILES
        for inf in ("inf where any overturned" if end == "mean" else "overturned counts as inf",)
    ),
    Variable("safe_island", "safe island", CASE, "1", "1 where a case stands although a lower intensity overturned it"),
    Variable("n_safe_islands", r"$n_{\mathrm{islands}}$", SUITE, "1", "members that stand above an overturning one"),
    Variable("limit_state", "limit state", LIMIT, "1", "theta_peak_over_alpha exceeded, or overturned"),
    Variable("p_exceeded", r"$P$", LIMIT, "1", "share that exceeds the limit state of those with an answer"),
    Variable("fragility_median", r"$\hat\theta$", LIMIT, "1", "intensity exceeded with probability 1/2; NaN: no curve"),
    Variable("fragility_median_low", r"$\hat\theta$", LIMIT, "1", "the same if all without an answer exceed it"),
    Variable("fragility_median_high", r"$\hat\theta$", LIMIT, "1", "the same if none without an answer exceeds it"),
    Variable("fragility_beta", r"$\beta$", LIMIT, "1", "standard deviation of the logarithm of the fragility curve"),
    Variable(
        "fragility_se_ln_median", r"$s$", LIMIT, "1", "standard error of ln(fragility_median), clustered by member"
    ),
    Variable("fragility_se_beta", r"$s_\beta$", LIMIT, "1", "standard error of fragility_beta, clustered by member"),
    Variable("fragility_correlation", r"$\rho$", LIMIT, "1", "correlation of the estimates of ln(median) and beta"),
    Variable("fragility_status", "status", LIMIT, "1", "whether there is a fragility curve, or why not"),
    Variable("measure", "measure", MEASURE, "1", "measure of the ground motion"),
    Variable("demand_spearman", r"$\rho_S$", MEASURE, "1", "rank correlation of theta_peak_over_alpha and the measure"),
    Variable(
        "demand_pearson", r"$\rho_P$", MEASURE, "1", "correlation of the logarithms, of members that rock and stand"
    ),
    Variable("n_moving", r"$n_{\mathrm{rock}}$", SUITE, "1", "members that rock and stand"),
    Variable("p_pgv_over_g_tan_alpha", r"$p\,\mathrm{PGV}/(g\,\tan\alpha)$", CASE, "1", "dimensionless peak velocity"),
    Variable("arias", r"$I_A$", CASE, "m s-1", "Arias intensity of the record used"),
    Variable("cav", "CAV", CASE, "m s-1", "cumulative absolute velocity of the record used"),
    Variable("t_mean", r"$T_m$", CASE, "s", "mean period of the record used (Rathje et al. 1998)"),
    Variable("d5_95", r"$D_{5-95}$", CASE, "s", "significant duration of the record used, 5-95 % of Arias intensity"),
)

MEASURES: tuple[str, ...] = ("pga", "pgv", "p_pgv_over_g_tan_alpha", "arias", "cav", "t_mean", "d5_95")
"""Measures of the ground motion that a suite's response is compared with."""
