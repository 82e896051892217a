"""Write the synthetic records of this folder: `python records/make_records.py [FOLDER]`.

The stochastic point-source method (Boore 1983, 2003): white noise under a Saragoni-Hart envelope is given the
Fourier amplitudes of Brune's omega-squared source after geometric spreading, anelastic attenuation, kappa and
site amplification.  The near-fault record adds the velocity pulse of Mavroeidis and Papageorgiou (2003) in their
way: the pulse's Fourier amplitudes are taken out of the noise, and the pulse is added in time.

Everything is in SI except where the literature's own units are kept (M0 in dyne cm, stress drop in bar,
beta in km/s, as Brune's corner frequency is always written).  References are in SOURCES.md.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rockcli.motion.at2 import at2_text

Array = NDArray[np.float64]

STANDARD_GRAVITY = 9.80665
BETA = 3.7  # shear wave speed at the source [km/s]
RHO = 2.8  # density there [g/cm^3]
STRESS_DROP = 140.0  # [bar]
HIGHPASS = 0.1  # corner of the baseline's high-pass [Hz]
PAD = 5.0  # quiet time before the motion, in which the acausal high-pass rings out [s]

ROCK = ((0.01, 1.0), (0.1, 1.1), (0.3, 1.25), (1.0, 1.7), (3.0, 2.2), (6.0, 2.5), (16.0, 2.9), (60.0, 3.4))
SOIL = ((0.01, 1.0), (0.1, 1.3), (0.3, 2.0), (0.7, 3.2), (1.5, 3.6), (3.0, 3.2), (6.0, 2.6), (16.0, 2.0), (60.0, 1.6))
"""Site amplification (frequency [Hz], factor): a generic rock of 620 m/s, and a deep soft soil; smoothed here
from the level and slope of published curves, not taken from any site."""


@dataclass(frozen=True)
class Scenario:
    """One record: file name, title, and what the method needs.

    `kappa` [s]; `site` a table of amplification; `pulse` (period [s], amplitude [m/s], gamma, phase [rad],
    centre [s]) or None.
    """

    name: str
    title: str
    magnitude: float
    distance_km: float
    kappa: float
    site: tuple[tuple[float, float], ...]
    dt: float
    npts: int
    seed: int
    pulse: tuple[float, float, float, float, float] | None = None


SCENARIOS = (
    Scenario("synthetic_rock_m65.AT2", "M6.5 15 km rock", 6.5, 15.0, 0.035, ROCK, 0.005, 4000, 3),
    Scenario("synthetic_soil_m70.AT2", "M7.0 30 km soft soil", 7.0, 30.0, 0.050, SOIL, 0.01, 4000, 6),
    Scenario(
        "synthetic_pulse_m70.AT2",
        "M7.0 near fault with a velocity pulse",
        7.0,
        15.0,
        0.040,
        ROCK,
        0.01,
        3000,
        3,
        # period from magnitude, log10 T_p = -2.9 + 0.5 M; 1 m/s, the level at which near-fault amplitudes cluster
        pulse=(10.0 ** (-2.9 + 0.5 * 7.0), 1.0, 1.6, 0.5 * np.pi, 8.5),
    ),
)


def corner_frequency(magnitude: float) -> float:
    """Brune's corner frequency [Hz]."""
    return float(4.9e6 * BETA * (STRESS_DROP / seismic_moment(magnitude)) ** (1.0 / 3.0))


def seismic_moment(magnitude: float) -> float:
    """Seismic moment [dyne cm] (Hanks and Kanamori 1979)."""
    return float(10.0 ** (1.5 * magnitude + 16.05))


def target_spectrum(f: Array, scenario: Scenario) -> Array:
    """Fourier amplitudes of acceleration [m/s] at frequencies f [Hz] (Boore 2003, eqs 1-9)."""
    r = scenario.distance_km
    scale = 0.55 * 0.707 * 2.0 / (4.0 * np.pi * RHO * BETA**3) * 1e-20  # radiation, partition, free surface; R0 = 1 km
    source = scale * seismic_moment(scenario.magnitude) / (1.0 + (f / corner_frequency(scenario.magnitude)) ** 2)
    quality = 180.0 * np.maximum(f, 0.1) ** 0.45
    path = np.exp(-np.pi * f * r / (quality * BETA)) / r
    frequencies, factors = np.array(scenario.site).T
    site = np.exp(np.interp(np.log(np.maximum(f, 0.01)), np.log(frequencies), np.log(factors)))
    site *= np.exp(-np.pi * scenario.kappa * f)
    baseline = 1.0 / (1.0 + (HIGHPASS / np.maximum(f, 1e-6)) ** 8)
    return np.asarray(source * path * site * (2.0 * np.pi * f) ** 2 * baseline / 100.0)


def envelope(t: Array, duration: float, epsilon: float = 0.2, eta: float = 0.05) -> Array:
    """Envelope of Saragoni and Hart: greatest (1) at epsilon t_eta, down to eta at t_eta = 2 duration."""
    b = -epsilon * np.log(eta) / (1.0 + epsilon * (np.log(epsilon) - 1.0))
    c = b / epsilon
    x = np.maximum(t, 0.0) / (2.0 * duration)
    return np.asarray((np.e / epsilon) ** b * x**b * np.exp(-c * x))


def pulse_velocity(t: Array, pulse: tuple[float, float, float, float, float]) -> Array:
    """Ground velocity [m/s] of the pulse (Mavroeidis and Papageorgiou 2003, eq. 3)."""
    period, amplitude, gamma, phase, centre = pulse
    x = 2.0 * np.pi * (t - centre) / period
    v = 0.5 * amplitude * (1.0 + np.cos(x / gamma)) * np.cos(x + phase)
    return np.where(np.abs(x) <= gamma * np.pi, v, 0.0)


def acceleration(scenario: Scenario) -> Array:
    """Ground acceleration of a scenario, (npts,) [m/s^2]."""
    dt, n = scenario.dt, 2 * scenario.npts
    t, f = dt * np.arange(n), np.fft.rfftfreq(n, dt)
    duration = 1.0 / corner_frequency(scenario.magnitude) + 0.05 * scenario.distance_km
    noise = np.random.default_rng(scenario.seed).standard_normal(n) * envelope(t - PAD, duration)
    spectrum = np.fft.rfft(noise)
    spectrum /= np.sqrt(np.mean(np.abs(spectrum) ** 2))
    target = target_spectrum(f, scenario)
    pulse = np.zeros(n)
    if scenario.pulse is not None:
        pulse = np.gradient(pulse_velocity(t, scenario.pulse), dt)
        target = np.maximum(target - np.abs(np.fft.rfft(pulse)) * dt, 0.0)
    a = np.fft.irfft(spectrum * target, n) / dt + pulse
    return settled(a[: scenario.npts], dt)


def settled(a: Array, dt: float) -> Array:
    """The motion with tapered ends whose velocity and displacement end at zero.

    What is subtracted is a smooth pair of waves over the whole length: less than a hundredth of PGA.
    """
    n = len(a)
    ramp = 0.5 - 0.5 * np.cos(np.pi * np.minimum(np.arange(n), n - 1 - np.arange(n)) * dt / 1.0)
    inside = np.minimum(np.arange(n), n - 1 - np.arange(n)) * dt < 1.0
    a = a * np.where(inside, ramp, 1.0)
    x = np.pi * np.arange(n) / (n - 1)
    shapes = np.array([np.sin(x) ** 2, np.sin(x) ** 2 * np.cos(x)])
    matrix = np.array([final_state(shape, dt) for shape in shapes]).T
    return np.asarray(a - np.linalg.solve(matrix, final_state(a, dt)) @ shapes)


def final_state(a: Array, dt: float) -> Array:
    """Velocity and displacement at the end, of acceleration linear between samples, from rest."""
    v = np.concatenate(([0.0], np.cumsum(0.5 * dt * (a[:-1] + a[1:]))))
    d = np.sum(v[:-1] * dt + dt * dt / 6.0 * (2.0 * a[:-1] + a[1:]))
    return np.array([v[-1], d])


def write(scenario: Scenario, folder: Path) -> None:
    """Write the AT2 file of a scenario."""
    titles = [
        "SYNTHETIC MOTION, NO RECORD OF AN EARTHQUAKE. MADE BY ROCKCLI, RECORDS/MAKE_RECORDS.PY",
        f"Synthetic {scenario.title}, no date, seed {scenario.seed}, H1",
    ]
    text = at2_text(acceleration(scenario) / STANDARD_GRAVITY, scenario.dt, titles)
    (folder / scenario.name).write_text(text, encoding="utf-8", newline="")


def main() -> None:
    """Write all records into the folder named, else into this one."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    for scenario in SCENARIOS:
        write(scenario, folder)


if __name__ == "__main__":
    main()
