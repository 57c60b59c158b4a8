"""Hammer tests of one oscillator: records that are the same on every run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from conftest import ROOT

RATE = 5000.0
NATURAL_HZ = 100.0
RATIO = 0.01

#: Measured hits, which the repository does not hold.
MEASURED = ROOT.parent / "shared" / "data" / "pyfrf_hammer"
MEASURED_RATE = 25_600.0


def oscillator(force: NDArray[np.float64], rate: float = RATE) -> NDArray[np.float64]:
    """Acceleration of 1 kg at 100 Hz with 1 % of critical damping, by short steps."""
    omega = 2 * np.pi * NATURAL_HZ
    acceleration = np.empty_like(force)
    u = v = 0.0
    for n, f in enumerate(force.tolist()):
        a = f - 2 * RATIO * omega * v - omega * omega * u
        v += a / rate
        u += v / rate
        acceleration[n] = a
    return acceleration


def record(
    peaks: tuple[float, ...] = (10.0, 12.0, 20.0, 24.0), seconds: float = 1.0
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Force (N) and acceleration (m/s^2) of hits one after the other, with noise."""
    samples = round(seconds * RATE)
    force = np.zeros(len(peaks) * samples)
    for number, peak in enumerate(peaks):
        begin = number * samples + 250
        force[begin : begin + 11] = peak * np.sin(np.linspace(0.0, np.pi, 11))
    acceleration = oscillator(force)
    noise = np.random.default_rng(1)
    return (
        force + 1e-3 * noise.standard_normal(len(force)),
        acceleration + 1e-3 * noise.standard_normal(len(force)),
    )


def write(path: Path, *channels: tuple[str, NDArray[Any]], rate: float = RATE) -> Path:
    """A file of named arrays, such as ("hammer [N]", force)."""
    np.savez(path, fs=np.float64(rate), **dict(channels))  # type: ignore[arg-type]
    return path


def sep005(
    *channels: tuple[str, str, NDArray[Any]], rate: float = RATE
) -> list[dict[str, Any]]:
    """SEP005 channels of (name, unit, data)."""
    return [
        {"name": name, "unit_str": unit, "data": data, "fs": rate} for name, unit, data in channels
    ]


def decay(seconds: float = 1.0) -> NDArray[np.float64]:
    """A blow after 50 ms and its free decay at 200 Hz with 1 % of critical damping, in m/s^2."""
    t = np.arange(round(seconds * 8000.0)) / 8000.0
    after = np.maximum(t - 0.05, 0.0)
    return np.asarray(np.exp(-12.566 * after) * np.sin(1256.6 * after))
