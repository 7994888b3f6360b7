"""``geofit report``: the accuracy report of a site."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from geofit.cli.app import app
from geofit.cli.console import guarded, listening
from geofit.cli.options import Json, LanguageCode, Out
from geofit.cli.running import run_site
from geofit.cli.sources import read_source

__all__ = ["report"]


@app.command()
@guarded
def report(
    site: Annotated[Path, typer.Argument(metavar="SITE", help="site.toml of a site.")],
    out: Out,
    lang: Annotated[LanguageCode, typer.Option(help="Language of the report: English or Chinese.")] = LanguageCode.EN,
    as_json: Json = False,
) -> int:
    """Fit every horizon of a site and write its accuracy report (HTML, PDF, JSON) with the surfaces it is about."""
    from geofit.data.languages import language

    with listening() as progress:
        return run_site(read_source(site, {}, None), out, (), {}, as_json, progress, language(lang.value), pdf=True)
