"""The tables of a survey: figures with the causes of error of the volume, loops, missing walls, strata, listed rows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geofit.caves.adjust import AdjustedSurvey, Loop
from geofit.caves.strata import Stratum
from geofit.data.errors import InputError
from geofit.data.site import ImportIssue
from geofit.gui.lengths import in_title, shown_length
from geofit.gui.panels.tables import TableColumn
from geofit.gui.translate import translated, user_language
from geofit.project.cave_run import CaveRun
from geofit.report import digits

__all__ = ["figure_rows", "issue_columns", "loop_columns", "stratum_columns", "wall_columns"]

#: Stations that name a loop.
_NAMED = 3
_WALLS = ("left", "right", "up", "down")


def figure_rows(adjusted: AdjustedSurvey, run: CaveRun | None) -> list[tuple[str, str]]:
    """Return names and values of the figures; those of the volume and what makes it uncertain once there is a body."""
    t, survey = user_language(), adjusted.survey
    low, high = np.nanmin(adjusted.xyz[:, 2]), np.nanmax(adjusted.xyz[:, 2])
    rows = [
        (t("stations, shots"), f"{len(survey.stations)}, {len(survey.start)}"),
        (in_title(t("surveyed length, m")), f"{shown_length(survey.length):.1f}"),
        (in_title(t("lowest to highest station, m")), f"{shown_length(float(high - low)):.1f}"),
        (t("loops, to be checked"), f"{len(adjusted.loops)}, {sum(loop.suspicious for loop in adjusted.loops)}"),
    ]
    if run is None:
        return rows
    v = run.volume
    square = max(v.sigma**2, 1e-300)
    causes = (
        (t("part of it from measured walls"), v.walls),
        (t("part of it from missing walls"), v.missing),
        (t("part of it from shot lengths"), v.survey),
    )
    return [
        *rows,
        (t("volume"), digits.volume(v.volume)),
        (t("standard deviation"), digits.volume(v.sigma)),
        *((name, f"{digits.volume(sigma)} ({100 * sigma**2 / square:.0f} %)") for name, sigma in causes),
        ("P10", digits.volume(v.p10)),
        ("P90", digits.volume(v.p90)),
        (t("missing walls, all walls"), f"{len(run.body.sections.filled)}, {len(run.body.sections.measured)}"),
        (in_title(t("spacing of the triangles, m")), f"{shown_length(run.spacing):.3g}"),
        (t("passages thinner than that"), str(len(run.body.thinner_than(run.spacing)))),
    ]


def loop_columns(adjusted: AdjustedSurvey) -> list[TableColumn]:
    """Return the loops, the worst first, with the misclosure that the adjustment spread."""
    t, loops = user_language(), adjusted.loops
    words = [t("to be checked") if loop.suspicious else t("closes") for loop in loops]
    return [
        TableColumn(t("Loop"), np.array([_loop(loop) for loop in loops], dtype=np.str_)),
        TableColumn(t("Length, m"), np.array([loop.length for loop in loops], float), 1),
        TableColumn(t("Misclosure, m"), np.array([loop.distance for loop in loops], float), 2),
        TableColumn("%", np.array([loop.percent for loop in loops], float), 2, t("Misclosure, % of the length")),
        TableColumn(t("Expected, m"), np.array([loop.expected for loop in loops], float), 2),
        TableColumn(t("Result"), np.array(words, dtype=np.str_)),
    ]


def wall_columns(run: CaveRun | None) -> list[TableColumn]:
    """Return the walls that were not measured, with the distance in their place."""
    t, filled = user_language(), () if run is None else run.body.sections.filled
    words = dict(zip(_WALLS, (t("left"), t("right"), t("up"), t("down")), strict=True))
    return [
        TableColumn(t("Station"), np.array([wall.station for wall in filled], dtype=np.str_)),
        TableColumn(t("Wall"), np.array([words[wall.wall] for wall in filled], dtype=np.str_)),
        TableColumn(t("Distance, m"), np.array([wall.distance for wall in filled], float), 2),
    ]


def stratum_columns(run: CaveRun | None) -> list[TableColumn]:
    """Return metres and cubic metres between horizons, from the top down."""
    t = user_language()
    parts = [] if run is None else [part for part in run.strata if part.known or part.length > 0 or part.volume > 0]
    return [
        TableColumn(t("Stratum"), np.array([_stratum(part) for part in parts], dtype=np.str_)),
        TableColumn(t("Length, m"), np.array([part.length for part in parts], float), 1),
        TableColumn(t("Volume, m³"), np.array([part.volume for part in parts], float), 0),
    ]


def issue_columns(issues: Sequence[ImportIssue]) -> list[TableColumn]:
    """Return the rows that the reader did not use, and what it assumed; the gravest first."""
    t = user_language()
    marks = {"error": t("not used"), "warning": t("warning"), "note": t("note")}
    issues = sorted(issues, key=lambda one: list(marks).index(one.severity))
    # An error joins its reason and remedy as the language does.
    words = [translated(InputError(one.reason, one.remedy)) for one in issues]
    return [
        TableColumn(t("Row"), np.array([one.row or np.nan for one in issues], float), 0),
        TableColumn(t("What"), np.array([marks[one.severity] for one in issues], dtype=np.str_)),
        TableColumn(t("Value"), np.array([one.value for one in issues], dtype=np.str_)),
        TableColumn(t("Reason and remedy"), np.array(words, dtype=np.str_)),
    ]


def _loop(loop: Loop) -> str:
    """Return the first stations of a loop, and how many it has."""
    count = len(loop.stations)
    return " – ".join(loop.stations[:_NAMED]) + (f" … ({count})" if count > _NAMED else "")


def _stratum(part: Stratum) -> str:
    t = user_language()
    if not part.known:
        return t("where a horizon has no height")
    if part.top and part.base:
        return t("{top} to {base}", top=part.top, base=part.base)
    return t("above {horizon}", horizon=part.base) if part.base else t("below {horizon}", horizon=part.top)
