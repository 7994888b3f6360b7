"""``geofit demo``: the sample site, fitted."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from geofit.cli.app import app
from geofit.cli.console import guarded, listening
from geofit.cli.options import Json, Out
from geofit.cli.running import run_site

__all__ = ["demo"]


@app.command()
@guarded
def demo(
    out: Out = Path("demo_out"),
    robust: Annotated[
        bool, typer.Option("--robust", help="Peripheral points that their neighbours deny take no part.")
    ] = False,
    as_json: Json = False,
) -> int:
    """Fit every horizon of the sample site, a fictional dam site."""
    from geofit.io.site_file import read_site

    site_file = _sample(out)
    with listening() as progress:
        site = read_site(site_file)
        return run_site(site, out, (), {"robust": True} if robust else {}, as_json, progress)


def _sample(out: Path) -> Path:
    """Find the sample site of the checkout, or make one now."""
    for root in (Path.cwd(), Path(__file__).resolve().parents[2]):
        if (root / "sample_data" / "site.toml").is_file():
            return root / "sample_data" / "site.toml"
    from geofit.sample import write_site

    write_site(out / "sample_data")
    return out / "sample_data" / "site.toml"
