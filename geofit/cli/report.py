"""``geofit report``: the accuracy report of a site."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from geofit.cli.app import app
from geofit.cli.console import listening, with_exit_code
from geofit.cli.options import Json, LanguageCode, Out
from geofit.cli.running import run_site
from geofit.cli.sources import read_source

__all__ = ["report"]

_SITE = "Default: [report] of the site file."


@app.command()
@with_exit_code
def report(
    site: Annotated[Path, typer.Argument(metavar="SITE", help="site.toml of a site.")],
    out: Out,
    lang: Annotated[LanguageCode, typer.Option(help="Language of the report: English or Chinese.")] = LanguageCode.EN,
    horizon: Annotated[list[str] | None, typer.Option(help="Report on this horizon only; may be repeated.")] = None,
    body: Annotated[
        list[str] | None,
        typer.Option(metavar="CODE", help="Code of logged intervals: fit a body to it, too; may be repeated."),
    ] = None,
    project: Annotated[str | None, typer.Option(help=f"Project number on the cover. {_SITE}")] = None,
    client: Annotated[str | None, typer.Option(help=f"Client. {_SITE}")] = None,
    organisation: Annotated[str | None, typer.Option(help=f"Who issues the report. {_SITE}")] = None,
    document: Annotated[str | None, typer.Option(help=f"Document number. {_SITE}")] = None,
    status: Annotated[str | None, typer.Option(help=f"Status: draft, for review, issued ... {_SITE}")] = None,
    author: Annotated[str | None, typer.Option(help=f"Who prepared it. {_SITE}")] = None,
    checker: Annotated[str | None, typer.Option(help=f"Who checked it. {_SITE}")] = None,
    approver: Annotated[str | None, typer.Option(help=f"Who approved it. {_SITE}")] = None,
    revision: Annotated[
        list[str] | None,
        typer.Option(
            metavar="MARK:TEXT", help="A revision of today's date, after those of the site file; may be repeated."
        ),
    ] = None,
    as_json: Json = False,
) -> int:
    """Fit every horizon of a site and write its accuracy report (HTML, PDF, JSON) with the surfaces it is about."""
    from geofit.data.languages import language
    from geofit.data.title_block import Revision
    from geofit.project.side_by_side import available, crew
    from geofit.report.gather import today

    stated = {
        "project": project,
        "client": client,
        "organisation": organisation,
        "document": document,
        "status": status,
        "author": author,
        "checker": checker,
        "approver": approver,
    }
    with listening() as progress, crew(1 if len(horizon or ()) == 1 else available()) as hands:
        read = read_source(site, {}, None)
        changes: dict[str, Any] = {key: text for key, text in stated.items() if text is not None}
        title = replace(read.title, **changes)
        for text in revision or ():
            mark, _, what = text.partition(":")
            title = replace(
                title, revisions=(*title.revisions, Revision(mark.strip(), today(), what.strip(), title.author))
            )
        read = replace(read, title=title)
        names = tuple(horizon or ())
        bodies = tuple(body or ())
        return run_site(
            read, out, names, {}, as_json, progress, language(lang.value), pdf=True, bodies=bodies, hands=hands
        )
