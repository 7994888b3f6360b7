"""``geofit cave``: a survey along centre lines to the body of its passages."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from geofit.cli.app import app
from geofit.cli.console import list_issues, listening, print_counts, print_json, print_table, say, with_exit_code
from geofit.cli.options import Json, Lang, LanguageCode, Out, Report

if TYPE_CHECKING:
    from geofit.caves.strata import Stratum
    from geofit.project.cave_run import CaveRun

__all__ = ["cave"]

SHOWN = 10


@app.command()
@with_exit_code
def cave(
    survey: Annotated[
        Path, typer.Argument(metavar="SURVEY", help="Compass .dat, Survex .svx, or a table of a centre line.")
    ],
    out: Out,
    radius: Annotated[float | None, typer.Option(help="Wall distance, m, for a survey without walls.")] = None,
    spacing: Annotated[
        float | None, typer.Option(help="Spacing of the triangles, m. Default: within 1 % of the volume.")
    ] = None,
    excavation: Annotated[
        Path | None,
        typer.Option(help="Planned excavation, a table of its axis with its section: gives the distance to it."),
    ] = None,
    horizon: Annotated[
        list[Path] | None,
        typer.Option(help="Surface (STEP, IGES, BREP, TSurf) that cuts the passages; repeat from the top down."),
    ] = None,
    report: Report = False,
    lang: Lang = LanguageCode.EN,
    as_json: Json = False,
) -> int:
    """Adjust a cave survey; give volume, surface, strata and distance to an excavation."""
    from geofit.data.progress import tell
    from geofit.io.surface_files import read_surfaces
    from geofit.project.cave_run import measure_passages, read_survey, write_passages

    measured = read_survey(survey)
    planned = None if excavation is None else read_survey(excavation)
    horizons = {name: surface for path in horizon or () for name, surface in read_surfaces(path).items()}
    surveys = [measured] if planned is None else [measured, planned]
    list_issues([issue for one in surveys for issue in one.issues], out)
    print_counts([count for one in surveys for count in one.counts])
    with listening() as progress:
        run = measure_passages(
            measured, radius=radius, spacing=spacing, excavation=planned, horizons=horizons, progress=progress
        )
        tell(progress, "files", 0.9)
        run = write_passages(run, out)
        if report:
            from geofit.data.languages import language
            from geofit.project.cave_report import write_cave_report

            run = replace(run, files=(*run.files, *write_cave_report(run, out, language(lang.value))))
    if as_json:
        print_json({**run.figures(), "files": [str(file) for file in run.files]})
    else:
        _print(run)
    for warning in run.uncorrected:
        say(f"warning: {warning}")
    say(f"Files: {', '.join(file.name for file in run.files)} in {out}")
    return 0


def _print(run: CaveRun) -> None:
    survey, volume, filled = run.adjusted.survey, run.volume, run.body.sections.filled
    thin = run.body.thinner_than(run.spacing)
    rows = [
        ("stations, shots", f"{len(survey.stations)}, {len(survey.start)}"),
        ("surveyed length, m", f"{survey.length:.1f}"),
        ("volume, m3", f"{volume.volume:.0f} ± {volume.sigma:.0f}"),
        ("volume P10, P90, m3", f"{volume.p10:.0f}, {volume.p90:.0f}"),
        (
            "sigma by measured, missing walls, shots, m3",
            f"{volume.walls:.0f}, {volume.missing:.0f}, {volume.survey:.0f}",
        ),
        ("filled walls", f"{len(filled)} of {len(run.body.sections.measured)}"),
        ("spacing of the triangles, m", f"{run.spacing:.3g}"),
        ("volume of the triangles, m3", f"{run.triangles.volume:.0f}"),
        ("shots thinner than that", str(len(thin))),
    ]
    print_table(("passages", survey.name), rows)
    loops = run.adjusted.loops
    if loops:
        cells = [
            (
                f"{loop.stations[0]} .. {loop.stations[-1]} ({len(loop.stations)})",
                f"{loop.length:.1f}",
                f"{loop.distance:.2f}",
                f"{loop.percent:.2f}",
                f"{loop.expected:.2f}",
                "yes" if loop.suspicious else "",
            )
            for loop in loops[:SHOWN]
        ]
        header = ("loop (stations)", "length, m", "misclosure, m", "%", "expected, m", "suspicious")
        print_table(header, cells, left=(0, 5))
        if len(loops) > SHOWN:
            say(f"The {SHOWN} worst of {len(loops)} loops; the others are in the table of loops.")
    if run.strata:
        cut = [_stratum(part) for part in run.strata if part.known or part.volume > 0 or part.length > 0]
        print_table(("stratum", "length, m", "volume, m3"), cut)
    if run.clearance is not None:
        away, n = run.clearance, run.clearance.nearest
        rows = [
            ("least distance to the excavation, m", f"{away.least:.2f} ± {away.sigma[n]:.2f}"),
            ("at", ", ".join(f"{value:.1f}" for value in away.points[n])),
            ("nearest station", away.station[n]),
        ]
        print_table(("planned excavation", ""), rows)
    if filled:
        shown = ", ".join(f"{wall.station} {wall.wall} {wall.distance:.2f} m" for wall in filled[:SHOWN])
        say(f"Walls filled from neighbours: {shown}{', ...' if len(filled) > SHOWN else ''}; all are in a table.")


def _stratum(part: Stratum) -> tuple[str, str, str]:
    if not part.known:
        name = "a horizon has no height"
    elif part.top and part.base:
        name = f"{part.top} – {part.base}"
    else:
        name = f"above {part.base}" if part.base else f"below {part.top}"
    return name, f"{part.length:.1f}", f"{part.volume:.0f}"
