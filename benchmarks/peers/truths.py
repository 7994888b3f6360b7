"""Three kinds of truth on 2 km x 2 km, and points of them: scattered, and on a grid, with a noise of 0.05 m."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[2] / "tests"))
from truth import EASTING, NORTHING, hills

__all__ = ["NOISE", "TRUTHS", "sample"]

Height = Callable[[np.ndarray, np.ndarray], np.ndarray]

SIZE, NOISE, PLACES = 2000.0, 0.05, 10_000
#: Share of each side at which nothing is compared: some programs do not extrapolate.
MARGIN = 0.05


def folds(seed: int) -> Height:
    """Return a train of asymmetric folds that plunge, on a dipping plane."""
    rng = np.random.default_rng(seed)
    length, azimuth, phase = rng.uniform(500, 800), rng.uniform(0, np.pi), rng.uniform(0, 2 * np.pi)
    c, s = np.cos(azimuth), np.sin(azimuth)

    def height(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        x, y = x - EASTING, y - NORTHING
        across, along = c * x + s * y, c * y - s * x
        angle = 2 * np.pi * across / length + phase + 0.4 * np.sin(along / 400)
        return 900 + 0.06 * along + 30 * np.sin(angle + 0.5 * np.sin(angle)) * (1 + 0.3 * np.cos(along / 600))

    return height


def rough(seed: int) -> Height:
    """Return a random field with a Matérn spectrum of smoothness 3/2, range 300 m: its second derivatives jump."""
    rng = np.random.default_rng(seed)
    waves, reach = 400, 300.0
    # The spectrum of this covariance in the plane is that of a Student t with 3 degrees of freedom, 1/range wide.
    k = rng.normal(size=(waves, 2)) / np.sqrt(rng.chisquare(3, waves) / 3)[:, None] / reach
    phase, amplitude = rng.uniform(0, 2 * np.pi, waves), 20 * np.sqrt(2 / waves)

    def height(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        total = np.zeros(np.shape(x))
        for (p, q), f in zip(k, phase, strict=True):
            total += np.sin(p * (x - EASTING) + q * (y - NORTHING) + f)
        return 400 + amplitude * total

    return height


TRUTHS: dict[str, Callable[[int], Height]] = {"hills": hills, "folds": folds, "rough": rough}


def sample(kind: str, n: int, seed: int) -> dict[str, np.ndarray]:
    """Return n scattered points, as many as nearly on a grid, and the true heights of places within the margin."""
    rng, height = np.random.default_rng(1000 + seed), TRUTHS[kind](seed)
    corner = np.array([EASTING, NORTHING])

    def points(plan: np.ndarray) -> np.ndarray:
        return np.column_stack([plan, height(*plan.T) + rng.normal(0, NOISE, len(plan))])

    side = np.linspace(0, SIZE, min(round(n**0.5), 320))
    mesh = np.stack(np.meshgrid(side, side, indexing="ij"), axis=-1).reshape(-1, 2)
    places = corner + rng.uniform(MARGIN * SIZE, (1 - MARGIN) * SIZE, (PLACES, 2))
    return {
        "xyz": points(corner + rng.uniform(0, SIZE, (n, 2))),
        "grid": points(corner + mesh),
        "places": places,
        "truth": height(*places.T),
    }
