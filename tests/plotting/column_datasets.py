"""Datasets of rocking columns made by hand: no solver in between."""

from __future__ import annotations

import numpy as np
import xarray

ALPHA, R = np.arctan(0.1), 25.0
LENGTH = 2.0 * R * np.cos(ALPHA)
MODELS = ("rigid", "flexible", "fallen")


def columns(models: tuple[str, ...] = MODELS, *, ends: float = 4.0, pulses: int = 0) -> xarray.Dataset:
    """A rigid body, a flexible column and one that falls, each with its history; over `pulses` motions if any."""
    t = np.arange(0.0, ends, 0.01)
    swing = 0.5 * ALPHA * np.sin(2.0 * t) * np.exp(-0.2 * t)
    fall = np.where(t < 2.0, -ALPHA * 0.25 * t**2, -ALPHA - 1.6 * (t - 2.0) ** 2)
    fall = np.where(np.abs(fall) <= 0.5 * np.pi, fall, np.nan)
    theta = np.array([fall if m == "fallen" else swing for m in models])
    bending = 0.05 * np.sign(theta)
    bending[[m == "rigid" for m in models]] = np.nan
    fell = np.array([m == "fallen" for m in models])
    ground = np.where(t < 1, 2.0 * np.sin(2.0 * np.pi * t), 0.0)
    data = {
        "theta": theta,
        "theta_dot": np.gradient(theta, t, axis=1),
        "a_g": np.where(np.isfinite(theta), ground, np.nan),
        "u_top": LENGTH * np.sin(theta) + np.nan_to_num(bending),
        "u_top_bending": bending,
        "outcome": np.where(fell, 2, 1).astype(np.int8),
        "t_overturn": np.where(fell, 2.0, np.nan),
        "theta_peak_over_alpha": np.where(fell, np.inf, 0.4),
    }
    dims: tuple[str, ...] = ("model",)
    coords: dict[str, object] = {"model": _axis("model", "model", models)}
    if pulses:
        data = {name: np.stack([values] * pulses) for name, values in data.items()}
        dims = ("pulse", *dims)
        coords["pulse"] = _axis("pulse", "motion.pulse", tuple(f"pulse {i}" for i in range(pulses)))
    items = {name: ((*dims, "time") if v.ndim > len(dims) else dims, v) for name, v in data.items()}
    coords |= {"time": t, "alpha": ALPHA, "p": 0.54, "R": R}
    attrs = {"title": "Columns", "axes": " ".join(dims), "compare_to": "null", "identity": "columns"}
    return xarray.Dataset(items, coords, attrs)


def _axis(name: str, path: str, labels: tuple[str, ...]) -> xarray.DataArray:
    return xarray.DataArray(np.array(labels, dtype=object), dims=name, attrs={"long_name": "words", "path": path})
