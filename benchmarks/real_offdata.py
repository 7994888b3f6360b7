"""Examine the real sets away from their data, beside thin plate and kriging, and write ``docs/real_offdata.md``.

Run ``python benchmarks/real_offdata.py [SET ...]``; for some sets the table is only printed. Needs ``GEOFIT_DATA`` or
``../shared/data``; without them it says so and exits with 2.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from realdata.sets import SETS, RealSet, data_folder

from geofit import FitSettings, GeofitError, PointSet, fit_horizon
from geofit.console import print_table
from geofit.examine import examine
from geofit.files import replacing
from geofit.offdata import LeftOut, OffData

PAGE = Path(__file__).resolve().parents[1] / "docs" / "real_offdata.md"
HEADER = (
    "set", "n", "holes", "geofit, m", "thin plate, m", "kriging, m", "inside 90 %", "before", "factor", "outliers",
    "field alone, m", "s",
)  # fmt: skip
#: geofit counts as no worse than another method up to this many times its error.
CLEARLY = 1.02


@dataclass(frozen=True)
class Row:
    """One horizon: its name, points, what was found, the field's own error, and the seconds it took."""

    name: str
    n: int
    found: OffData | str
    alone: float
    seconds: float

    @property
    def holes(self) -> LeftOut | None:
        """Return what leaving out hole by hole found."""
        if isinstance(self.found, str):
            return None
        return next((one for one in self.found.left_out if one.scheme == "hole"), None)


def examine_set(real: RealSet) -> list[Row]:
    rows = []
    for name, points in real.site.horizons.items():
        settings = real.scale or FitSettings()
        try:
            surface = fit_horizon(points, settings, real.site.boundary, name=name)
        except GeofitError as error:
            rows.append(Row(f"{real.title}: {name}", len(points), str(error), np.nan, 0.0))
            continue
        start = time.perf_counter()
        found = examine(surface)
        seconds = time.perf_counter() - start
        alone = field_alone(points, real) if found.uncertainty else float("nan")
        rows.append(Row(f"{real.title}: {name}", len(points), found, alone, seconds))
    return rows


def field_alone(points: PointSet, real: RealSet) -> float:
    """Return the error at holes left out of the regional field: no point pulled, no core."""
    settings = FitSettings(core="none", max_iterations=0)
    try:
        found = examine(fit_horizon(points, settings, real.site.boundary))
    except GeofitError:
        return float("nan")
    return next((one.rms for one in found.left_out if one.scheme == "hole"), float("nan"))


def cells(row: Row) -> tuple[str, ...]:
    holes = row.holes
    if holes is None or isinstance(row.found, str):
        return (row.name, str(row.n), *[""] * 9, "")
    uncertainty = row.found.uncertainty
    return (
        row.name,
        str(row.n),
        str(holes.groups),
        metres(holes.rms),
        *(metres(holes.peers.get(peer, np.nan)) for peer in ("thin plate", "kriging")),
        f"{100 * holes.inside:.0f} %",
        f"{100 * holes.inside_raw:.0f} %",
        f"{uncertainty.factor:.2f}" if uncertainty else "",
        str(len(row.found.outliers)),
        metres(row.alone),
        f"{row.seconds:.1f}",
    )


def metres(value: float) -> str:
    return "" if not np.isfinite(value) else f"{value:.4f}" if value < 0.1 else f"{value:.3g}"


def markdown(rows: list[Row]) -> str:
    judged = [(row, row.holes) for row in rows if row.holes is not None and row.holes.peers]
    won = sum(holes.rms <= CLEARLY * min(holes.peers.values()) for _, holes in judged)
    held = sum(0.85 <= round(holes.inside, 2) <= 0.95 for _, holes in judged)
    lines = [
        "# Real data: the error off the data",
        "",
        "Made by `benchmarks/real_offdata.py`; do not edit. Every hole (or point, where no hole is named) of every set",
        "is left out in turn and predicted from all others: by geofit's own linear algebra (smoothing and knots stay),",
        "by the exact thin-plate spline, and by ordinary kriging. Errors are root mean squares; steep horizons are",
        'measured across their best plane. "inside" is the share of left-out holes within the 90 % band, after and',
        'before it was held to what points left out show; "field alone" is geofit without core and tolerance.',
        "",
        "| " + " | ".join(HEADER[:-1]) + " |",
        "| --- |" + " ---: |" * (len(HEADER) - 2),
        *("| " + " | ".join(cells(row)[:-1]) + " |" for row in rows),
        "",
        f"On {won} of {len(judged)} horizons geofit's error is at most {CLEARLY:g} times that of the better of the",
        f"two; on {held} the band holds 85 to 95 % of the holes.",
        "",
        "## What does not hold",
        "",
    ]
    for row, holes in judged:
        best = min(holes.peers, key=lambda peer: holes.peers[peer])
        words = []
        if holes.rms > CLEARLY * holes.peers[best]:
            ratio = holes.rms / holes.peers[best]
            words.append(f"{ratio:.2f} x the error of {best}; the field alone {row.alone / holes.peers[best]:.2f} x")
        if not 0.85 <= round(holes.inside, 2) <= 0.95:
            words.append(f"{100 * holes.inside:.0f} % of {holes.groups} holes inside the 90 % band")
        if words:
            lines.append(f"- **{row.name}**: {'; '.join(words)}.")
    lines += [f"- **{row.name}**: {row.found}" for row in rows if isinstance(row.found, str)]
    lines += [
        f"- **{row.name}**: {note}"
        for row in rows
        if not isinstance(row.found, str) and row.holes is None
        for note in row.found.notes
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Run the sets that are named, or all."""
    folder = data_folder()
    if folder is None:
        print("The real data are not here. Set GEOFIT_DATA, or lay them at ../shared/data.", file=sys.stderr)
        return 2
    unknown = [key for key in sys.argv[1:] if key not in SETS]
    if unknown:
        print(f"There is no set '{unknown[0]}'; the sets are: {', '.join(SETS)}.", file=sys.stderr)
        return 2
    keys = [key for key in SETS if key in sys.argv[1:]] or list(SETS)
    rows = [row for key in keys for row in examine_set(SETS[key](folder))]
    print_table(HEADER, [cells(row) for row in rows])
    if len(keys) == len(SETS):
        with replacing(PAGE) as part:
            part.write_text(markdown(rows), encoding="utf-8")
        print(f"written: {PAGE}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
