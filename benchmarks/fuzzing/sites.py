"""Messy sites: each is fitted and examined, or ends in a geofit error."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np

from geofit import FitSettings, PointSet, fit_horizon
from geofit.checks.check import CORE_LIMIT
from geofit.data.messages import Message
from geofit.prediction.examine import examine

__all__ = ["LAYOUTS", "fit_one", "messy"]

#: Code of the message that takes the place of an examination that failed.
UNFORESEEN = "data.unforeseen-error"
#: Layouts of points in plan, as people bring them.
LAYOUTS = (
    "three", "two places", "square", "one place", "vertical hole", "line", "sections", "core", "cloud", "lattice",
    "tiny", "huge", "degrees", "repeated", "cluster",
)  # fmt: skip


def messy(rng: np.random.Generator, layout: str) -> tuple[PointSet, FitSettings, np.ndarray | None]:
    """Return points of a layout, with noise, gaps and repetitions, settings, and perhaps a study area."""
    n = int(rng.integers(3, 60))
    size = float(10 ** rng.uniform(0, 4))
    plan = rng.uniform(0, size, (n, 2))
    match layout:
        case "three":
            plan = plan[:3]
        case "two places":
            plan = plan[rng.integers(0, 2, n)]
        case "square":
            plan = size * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
        case "one place" | "vertical hole":
            plan = np.repeat(plan[:1], n, axis=0)
        case "line":
            plan[:, 1] = plan[:, 0] * rng.uniform(-2, 2)
        case "sections":
            plan[:, 1] = size / 4 * rng.integers(0, 4, n)
        case "core":
            rows = [np.column_stack([rng.uniform(0.3, 0.7, k) * size, np.full(k, y * size)])
                    for k, y in zip(rng.integers(8, 24, 3), (0.3, 0.5, 0.7), strict=True)]  # fmt: skip
            plan = np.concatenate([*rows, rng.uniform(0, size, (int(rng.integers(4, 16)), 2))])
        case "lattice":
            axis = np.arange(6) * size / 5
            plan = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
        case "tiny":
            plan *= 2e-3 / size
        case "huge":
            plan *= 1e9 / size
        case "degrees":
            plan *= 0.05 / size
        case "repeated":
            plan = plan[rng.integers(0, max(n // 2, 1), n)]
        case "cluster":
            plan[n // 2 :] = plan[0] + plan[n // 2 :] * 1e-3
    x, y = plan.T / max(float(np.ptp(plan)), 1e-9)
    z = 0.1 * size * (np.sin(4 * x) + y) + rng.normal(0, rng.choice([0.0, 0.1, 5.0]), len(plan))
    if layout == "vertical hole":
        z = np.arange(len(plan), dtype=float)
    shift = np.array([110.1, 30.2] if layout == "degrees" else [500_000.0, 3_100_000.0])
    names = np.where(rng.uniform(size=len(plan)) < 0.3, "", [f"S{int(4 * value)}" for value in y])
    points = PointSet(np.column_stack([plan + shift, z]), section=names if layout == "sections" else "")
    settings = FitSettings(
        core=str(rng.choice(["auto", "auto", "all", "none"])),  # type: ignore[arg-type]
        frame=str(rng.choice(["auto", "auto", "auto", "map", "best-plane", "sections"])),  # type: ignore[arg-type]
        robust=bool(rng.uniform() < 0.2),
    )
    low, high = plan.min(axis=0) + shift, plan.max(axis=0) + shift
    area = None
    if rng.uniform() < 0.3:
        area = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])[rng.permutation(4) if n % 3 else slice(None)]
    return points, settings, area


def fit_one(seed: int) -> Counter[str]:
    """Fit and examine one messy site; return what came of it."""
    rng = np.random.default_rng(seed)
    layout = LAYOUTS[seed % len(LAYOUTS)]
    points, settings, area = messy(rng, layout)
    surface = fit_horizon(points, settings, area)
    assert surface.accuracy is not None
    residuals = surface.accuracy.residuals
    if not np.isfinite(residuals).all():
        raise AssertionError("residuals are not finite")
    if surface.diagnostics["frame"] == "sections" and np.abs(residuals[surface.core]).max(initial=0.0) > CORE_LIMIT:
        raise AssertionError("a point is called exact and is missed")
    notes = [*surface.accuracy.notes, *examine(surface).notes]
    unforeseen = [note for note in notes if UNFORESEEN in _codes(note)]
    if unforeseen:
        raise AssertionError(f"{layout}: {unforeseen[0]}")
    return Counter(["fitted"])


def _codes(note: object) -> Iterator[str]:
    """Give the code of a message and of those within it."""
    if isinstance(note, Message):
        yield note.code
        for value in note.params.values():
            for part in value if isinstance(value, tuple) else (value,):
                yield from _codes(part)
