"""One sine cycle on the linearized block against the piecewise closed form (Zhang & Makris 2001, appendix)."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import G, pulse, rock, unit_block

CASES = [
    {
        "Omega": 2.0,
        "A": 1.2,
        "uplift": 0.49255539166887283,
        "t_impact": [1.72723429236195938, 4.91647137804330518, 6.93395426394992278],
        "w": [-0.307239489307575775, 0.850267740472641589, -0.76524096642537743],
        "peak": 0.473649575366801277,
        "t": [0.942477796076937972, 1.88495559215387594, 3.14159265358979324, 4.08407044966673121, 6.28318530717958648],
        "phi": [0.012845666867768832, -0.0373828426046116021, -0.40150845863787508, -0.4254588047826427, 0.314567659296134074],
    },
    {
        "Omega": 0.3,
        "A": 1.03,
        "uplift": 4.42950414676306679,
        "t_impact": [],
        "w": [],
        "peak": 0.424383320182030141,
        "t": [6.28318530717958648, 12.566370614359173, 20.9439510239319549, 27.2271363311115414],
        "phi": [0.0427565853423096144, -0.00127024669802624902, -0.19215771424579548, 0.0855986966286906176],
    },
    {
        "Omega": 20.0,
        "A": 15.0,
        "uplift": 0.00333580742051126298,
        "t_impact": [0.727900107713792799, 2.06693878474491629, 3.23668216295975429],
        "w": [-0.649626239507575372, 0.584663615556817835, -0.526197254001136051],
        "peak": 0.197181130720770496,
        "t": [0.0942477796076937972, 0.188495559215387594, 0.314159265358979324, 0.408407044966673121, 0.628318530717958648],
        "phi": [0.0307492107543305595, 0.14633897043678771, 0.189692387622103788, 0.159626600022115703, 0.0598354320797811683],
    },
]  # fmt: skip


@pytest.mark.parametrize("case", CASES, ids=lambda c: f"Omega={c['Omega']:g}")
def test_one_sine_history(case):
    alpha = 0.1
    motion = pulse("sine", -case["A"] * G * alpha, case["Omega"])  # -a_g drives theta > 0
    response = rock(unit_block(alpha), motion, model="linearized", eta=0.9, histories=True)
    n = len(case["t_impact"])
    assert response.scalars["t_uplift"][0] == pytest.approx(case["uplift"], rel=1e-10)
    assert response.scalars["theta_peak_over_alpha"][0] == pytest.approx(case["peak"], rel=1e-10)
    np.testing.assert_allclose(response.impacts["t_impact"][0, :n], case["t_impact"], rtol=1e-10)
    np.testing.assert_allclose(response.impacts["theta_dot_before"][0, :n] / alpha, case["w"], rtol=1e-10)
    for t, phi in zip(case["t"], case["phi"], strict=True):
        fine = rock(unit_block(alpha), motion, model="linearized", eta=0.9, histories=True, dt_out=t / 50)
        assert fine.histories["theta"][0, 50] / alpha == pytest.approx(phi, abs=1e-10)
