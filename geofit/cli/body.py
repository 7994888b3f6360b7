"""``geofit body``: logged intervals, outlines on sections or picked points to a closed body."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from geofit.cli.app import app
from geofit.cli.body_lines import BodyLines, body_lines
from geofit.cli.console import list_issues, listening, print_counts, print_json, print_table, say, with_exit_code
from geofit.cli.options import (
    Author,
    Certificate,
    Json,
    Lang,
    LanguageCode,
    LengthUnit,
    Organisation,
    OriginChoice,
    Out,
    Report,
)
from geofit.cli.signing import read_origin, signed_by
from geofit.data.errors import InputError, SettingsError
from geofit.data.messages import Message, message
from geofit.data.numbers import is_finite

if TYPE_CHECKING:
    from geofit.bodies.settings import BodySettings
    from geofit.data.site import Site
    from geofit.io.boreholes import Boreholes
    from geofit.project.body_run import BodyRun
    from geofit.project.body_sources import SourceData

__all__ = ["body", "print_body"]


@app.command()
@with_exit_code
def body(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="SOURCE",
            help="site.toml with [boreholes], a table of collars, outlines on sections (DXF, GeoJSON; with --layer the "
            "flat drawings of a site.toml), or a table of points on the body.",
        ),
    ],
    out: Out,
    code: Annotated[
        list[str] | None, typer.Option(help="Of boreholes: code of the intervals inside the body; may be repeated.")
    ] = None,
    layer: Annotated[
        list[str] | None, typer.Option(help="Of outlines: their layer, by default all; may be repeated.")
    ] = None,
    survey: Annotated[Path | None, typer.Option(help="With a collar table: depth, azimuth and dip.")] = None,
    intervals: Annotated[
        list[Path] | None, typer.Option(help="With a collar table: logged intervals; may be repeated.")
    ] = None,
    unit: LengthUnit = None,
    epsilon: Annotated[float, typer.Option(help="Control error for sigma, m.")] = 0.5,
    spacing: Annotated[
        float | None, typer.Option(help="Spacing of the triangles, m. Default: chosen from the holes and the size.")
    ] = None,
    author: Author = None,
    organisation: Organisation = None,
    certificate: Certificate = False,
    origin: OriginChoice = "map",
    report: Report = False,
    lang: Lang = LanguageCode.EN,
    as_json: Json = False,
) -> int:
    """Fit a closed body to logged intervals, outlines or points: STEP, triangles, volumes, residuals."""
    from geofit.bodies.questions import section_questions
    from geofit.bodies.settings import BodySettings
    from geofit.io.boreholes import Boreholes
    from geofit.project.body_files import write_triangles
    from geofit.project.body_run import run_body
    from geofit.project.side_by_side import available

    if spacing is not None and not (is_finite(spacing) and spacing > 0):
        raise SettingsError(
            message(
                "cli.spacing-not-positive",
                "The spacing of the triangles is {value} m; a finite length above 0 is needed.",
                value=spacing,
            )
        )
    hands = available()
    settings, zero = BodySettings(epsilon=epsilon), read_origin(origin)
    title, page = None, lang.value if certificate else ""
    with listening() as progress:
        drawn = _drawn(source, bool(code or survey or intervals), layer or [], settings, unit)
        if drawn is not None:
            list_issues(drawn.issues, out)
            name = _name(source, layer or [])
            signed = signed_by(None, author, organisation, zero, certificate=page)
            run = run_body(
                drawn.data, out, name=name, settings=settings, progress=progress, signed=signed, workers=hands
            )
        else:
            holes = _read(source, survey, intervals or [], unit)
            list_issues(holes.issues, out)
            print_counts(holes.counts)
            if not code:
                raise _no_code(source, holes)
            title = getattr(holes, "title", None)
            site = None if isinstance(holes, Boreholes) else holes
            signed = signed_by(site, author, organisation, zero, certificate=page)
            run = run_body(holes, out, codes=code, settings=settings, progress=progress, signed=signed, workers=hands)
        if spacing is not None:
            (stl,) = (file for file in run.files if file.suffix == ".stl")
            write_triangles(run.body.mesh_at(spacing), stl.with_suffix(""), run.body.origin)
        if report:
            from geofit.data.languages import language
            from geofit.project.single_reports import write_body_report

            pages = write_body_report(run, out, language(lang.value), title=title, progress=progress)
            run = replace(run, files=(*run.files, *pages))
    if as_json:
        print_json({**run.figures(), "files": [str(file) for file in run.files]})
    else:
        print_body(body_lines(run))
    _print_issues(run)
    if drawn is not None and drawn.outlines:
        for question in section_questions(drawn.outlines, run.body):
            say(f"question: {question.text}")
    for text in run.failed_checks:
        say(f"Check failed: {text}")
    say(f"Files: {', '.join(file.name for file in run.files)} in {out}")
    return run.exit_code


def _drawn(
    source: Path, of_holes: bool, layers: list[str], settings: BodySettings, unit: str | None
) -> SourceData | None:
    """Read outlines or points; None: the source is of boreholes."""
    from geofit.io.outlines import OUTLINE_ENDINGS
    from geofit.project.body_record import Outlines, SurfacePicks
    from geofit.project.body_sources import read_body_source

    ending = source.suffix.casefold()
    outlined = ending in OUTLINE_ENDINGS and (bool(layers) or ending != ".toml")
    if (layers and not outlined) or (of_holes and outlined):
        raise InputError(
            message("cli.layer-of-outlines", "--layer is for outlines; --code, --survey and --intervals for boreholes"),
            message("cli.leave-out-option", "Leave out what does not belong to the source."),
            file=str(source),
        )
    if outlined:
        return read_body_source(Outlines(source.name, tuple(layers)), settings, (), source.parent, unit=unit)
    if of_holes or ending == ".toml":
        return None
    return read_body_source(SurfacePicks(source.name), settings, (), source.parent, unit=unit)


def _name(source: Path, layers: list[str]) -> str:
    """Return what a body of outlines or points is called: a site file may hold several, each on its layer."""
    return "+".join(layers) if source.suffix.casefold() == ".toml" else source.stem


def _read(source: Path, survey: Path | None, intervals: list[Path], unit: str | None) -> Boreholes | Site:
    if source.suffix.casefold() != ".toml":
        from geofit.io.boreholes import read_boreholes
        from geofit.io.source import Source

        if not intervals:
            raise InputError(
                message("cli.collars-without-intervals", "A table of collars alone has no logged intervals"),
                message("cli.give-intervals", "Give the tables of intervals with --intervals."),
                file=str(source),
            )
        tables = [Source(path=path, unit=unit) for path in (source, *intervals)]
        along = None if survey is None else Source(path=survey, unit=unit)
        return read_boreholes(tables[0], along, tables[1:])
    if unit is not None:
        raise InputError(
            message("cli.unit-of-site", "--unit is not for a site file"),
            message("cli.state-unit-in-site", "A site file states unit in [site]."),
            file=str(source),
        )
    if survey is not None or intervals:
        raise InputError(
            message("cli.options-for-collars", "--survey and --intervals are for a table of collars"),
            message("cli.site-file-has-tables", "A site file names its own tables in [boreholes]."),
            file=str(source),
        )
    from geofit.io.site_file import load_site

    return load_site(source)


def _no_code(source: Path, holes: Boreholes | Site) -> InputError:
    """Return what to say where no code is named: the codes that there are."""
    from collections import Counter

    from geofit.io.boreholes import Boreholes

    campaigns = (holes,) if isinstance(holes, Boreholes) else holes.boreholes
    counts = Counter(str(code) for campaign in campaigns for log in campaign.logs for code in log.code)
    frequent = ", ".join(f"{code} ({count})" for code, count in counts.most_common(12))
    return InputError(
        message("cli.code-missing", "No code is given for the intervals in the body"),
        message("cli.name-code", "Name it with --code. The most frequent are: {codes}.", codes=frequent),
        file=str(source),
    )


def _print_issues(run: BodyRun) -> None:
    kinds: dict[tuple[str, bool], list[Message]] = {}
    for issue in (one for one in run.body.issues if one.kind != "file"):
        kinds.setdefault((issue.kind, issue.used), []).append(issue.text)
    for (_, used), texts in sorted(kinds.items(), key=lambda kind: kind[0][1]):
        more = f" ({len(texts) - 1} more like it in the JSON file)" if len(texts) > 1 else ""
        say(f"{'note' if used else 'not used'}: {texts[0]}{more}")


def print_body(found: BodyLines) -> None:
    """Print the figures of a body as a table."""
    print_table(("body", found.name), found.rows, left=(0, 1))
    for sentence in found.sentences:
        say(sentence)
