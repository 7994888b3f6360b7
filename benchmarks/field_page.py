"""The pages docs/field.md and docs/real_folds.md, from what benchmarks/field.py measured."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from field_trials import TRIALS

__all__ = ["METHODS", "Folds", "Row", "folds_table", "methods_table", "write_folds", "write_page"]

_HEAD = """# Errors of the field on seeded sites

Written by `python benchmarks/field.py sites {low} {high} --page`; do not edit. Each site has about 600 points: 11
sections of 40 points in a dense core, straight, crooked, crossing or at unequal distances, and 157 boreholes around it.
The truths are sums of waves, hills, folds, and random fields of three smoothnesses. "Core" and "whole" are root mean
square errors at 4,000 places of the core and of the whole area, divided by those of scipy's exact thin-plate spline of
the same points. Settings are the defaults. A core counts as exact if every point is met but those of two that
contradict each other at almost the same place; one of each pair is released and named.
"""
_FOLDS_HEAD = """# Ten-fold cross-validation of the real sets

Written by `python benchmarks/field.py real --page`; do not edit. The boreholes of each set (points, where no hole is
named) are divided into ten folds. Each fold is predicted from the others, and each method estimates its parameters
without that fold: geofit with default settings, the exact thin plate, a thin plate smoothed by generalized
cross-validation, ordinary kriging with a fitted variogram, and dense Gaussian processes (GP) with a constant or a plane
as drift and the likelihood's choice of exponential, Matérn 3/2, Matérn 5/2 and Gaussian kernels. (Kriging estimates one
variogram from all points of a set that is too large for one per fold.) The errors are root mean squares in metres at
the points where geofit returns an elevation; "none" counts the other points. The last column is geofit's error divided
by the smallest error of the reference methods, which is known only in retrospect. The second table applies the same
measure to every method. A dash marks an error that does not exist: kriging has no solution for coincident points.

"""
_DRAWN_HEAD = """
## How near a method can come

The reference that turns out best on a line owes part of that to chance, so a ratio near 1 on every line is out of
reach. To see how far, {draws} sets of elevations were drawn at the places of each horizon of 20 to 200 points, from the
Gaussian process that is likeliest there (kernel, range, nugget and plane). Kriging with that covariance is the best
linear prediction there is; its ratio to the best of the five references is in the last row.

"""
_TRIED = """
## What was tried

Each line was measured before and after on 48 to 96 sites that the change was not chosen on, and on ten folds over the
holes of the Chamaya, Kimberlina, Weka Hills and Copper Creek data. GM: geometric mean of the ratio to the thin plate.

| change | measured | kept |
| --- | --- | --- |
{rows}

How near any field can come: kriging that is told the truth's own covariance, noise and relief reaches, over the whole
area of 60 of these sites, a median of 0.99 on Matérn 3/2 truths, 0.86 on Matérn 5/2 and 0.31 on Gaussian ones. Most of
what is left on the others lies beyond the hull of the points: 5 to 7 % of the area, 12 to 83 % of the squared error on
the sites looked at.
"""


@dataclass(frozen=True)
class Row:
    """One site: its words, and core and whole ratio, largest distance of a core point, control points a point."""

    kind: str
    layout: str
    noise: float
    least: float
    core: float
    whole: float
    exact: float
    points: int
    a_point: float


#: The methods compared; geofit first.
METHODS = ("geofit", "thin plate", "smoothing plate", "kriging", "GP, constant", "GP, plane")


@dataclass(frozen=True)
class Folds:
    """One horizon: number of points, of those without an elevation, and RMS error of each method, metres.

    ``truth`` is that of kriging with the covariance that the elevations were drawn from; nan for measured ones.
    """

    title: str
    points: int
    none: int
    errors: tuple[float, ...]
    truth: float = np.nan

    def ratio(self, method: int) -> float:
        """Return the error of a method divided by the smallest error of the others; nan if it has none."""
        return self.errors[method] / float(np.nanmin([e for k, e in enumerate(self.errors) if k != method]))

    @property
    def ratio_of_truth(self) -> float:
        """The error of kriging with the truth's covariance divided by the smallest of the reference methods."""
        return self.truth / float(np.nanmin(self.errors[1:]))


def folds_table(lines: Sequence[Folds]) -> list[str]:
    """Return the lines of a table of the horizons and of one of the methods."""
    rows = [
        f"| set | n | none | {' | '.join(METHODS)} | ratio to the best |",
        "| --- |" + " ---: |" * (len(METHODS) + 3),
    ]
    for line in lines:
        cells = [*(f"{error:.3g}" for error in line.errors), f"{line.ratio(0):.2f}"]
        shown = " | ".join("–" if cell == "nan" else cell for cell in cells)
        rows.append(f"| {line.title} | {line.points} | {line.none} | {shown} |")
    return [*rows, "", *methods_table(lines)]


def methods_table(lines: Sequence[Folds]) -> list[str]:
    """Return the lines of a table of the methods."""
    rows = ["| method | lines | ratio to the best: median | geometric mean | worst | at most 1.02 | at most 1.15 |"]
    rows.append("| --- |" + " ---: |" * 6)
    of_methods = {method: [line.ratio(k) for line in lines] for k, method in enumerate(METHODS)}
    of_methods["kriging with the truth's covariance"] = [line.ratio_of_truth for line in lines]
    for method, given in of_methods.items():
        ratios = np.array(given)[np.isfinite(given)]
        if len(ratios):
            rows.append(
                f"| {method} | {len(ratios)} | {np.median(ratios):.2f} | {np.exp(np.log(ratios).mean()):.2f} | "
                f"{ratios.max():.4g} | {np.mean(ratios <= 1.02):.0%} | {np.mean(ratios <= 1.15):.0%} |"
            )
    return rows


def write_folds(lines: Sequence[Folds], drawn: Sequence[Folds], draws: int, docs: Path) -> None:
    """Write ``real_folds.md`` into the folder of the documentation."""
    parts = [_FOLDS_HEAD, "\n".join(folds_table(lines)), "\n", _DRAWN_HEAD.format(draws=draws)]
    (docs / "real_folds.md").write_text("".join([*parts, "\n".join(methods_table(drawn)), "\n"]), encoding="utf-8")


def write_page(rows: Sequence[Row], seeds: tuple[int, int], docs: Path) -> None:
    """Write ``field.md`` into the folder of the documentation."""
    parts = [_HEAD.format(low=seeds[0], high=seeds[1])]
    lost = sum(not row.exact < 1e-6 for row in rows)
    parts.append(
        f"{len(rows)} sites: the core is not exact on {lost}; whole area above the thin plate's on "
        f"{sum(row.whole > 1 for row in rows)}, core on {sum(row.core > 1 for row in rows)}.\n"
    )
    groups: list[tuple[str, Callable[[Row], str]]] = [
        ("all", lambda row: "all sites"),
        ("truth", lambda row: row.kind),
        ("layout", lambda row: row.layout),
        ("noise", lambda row: f"{row.noise:g} m"),
        ("least spacing", lambda row: f"{row.least:g} m"),
    ]
    parts.append(
        "| | sites | core: median | worst | whole: median | worst | whole at most 0.62 | "
        "control points a point: median | worst |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
    )
    for name, key in groups:
        for value in dict.fromkeys(key(row) for row in rows):
            some = [row for row in rows if key(row) == value]
            core, whole, size = (np.array([getattr(row, one) for row in some]) for one in ("core", "whole", "a_point"))
            label = value if name in ("all", "truth", "layout") else f"{name} {value}"
            parts.append(
                f"| {label} | {len(some)} | {np.median(core):.2f} | {core.max():.2f} | {np.median(whole):.2f} | "
                f"{whole.max():.2f} | {np.mean(whole <= 0.62):.0%} | {np.median(size):.1f} | {size.max():.1f} |"
            )
    tried = _TRIED.format(rows="\n".join(f"| {change} | {figures} | {kept} |" for change, figures, kept in TRIALS))
    (docs / "field.md").write_text("\n".join(parts) + "\n" + tried, encoding="utf-8")
