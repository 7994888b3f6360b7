"""``geofit demo``: the sample site and its ore lens, fitted."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from geofit.cli.app import app
from geofit.cli.body import print_body
from geofit.cli.body_lines import fit_and_describe
from geofit.cli.console import listening, say, with_exit_code
from geofit.cli.options import Json, Out
from geofit.cli.running import run_site

__all__ = ["demo"]

#: Code of the body that is fitted.
BODY = "ORE"


@app.command()
@with_exit_code
def demo(
    out: Out = Path("demo_out"),
    robust: Annotated[
        bool, typer.Option("--robust", help="Peripheral points that their neighbours contradict take no part.")
    ] = False,
    as_json: Json = False,
) -> int:
    """Fit every horizon of the sample site, a fictional dam site, and the ore lens below it."""
    from geofit.project.side_by_side import available, crew

    # Before anything else is imported here: the processes import what they need meanwhile.
    with listening() as progress, crew(available()) as hands:
        from geofit.io.site_file import read_site

        site_file = _sample(out)
        begun = hands.begin(partial(fit_and_describe, site_file.with_name("bodies.toml"), BODY, out / "bodies"))
        site = read_site(site_file)
        code = run_site(site, out, (), {"robust": True} if robust else {}, as_json, progress, hands=hands)
        found = begun()
    if not as_json:
        print_body(found)
    say(f"Body {BODY}: {found.files} files in {out / 'bodies'}")
    return max(code, found.exit_code)


def _sample(out: Path) -> Path:
    """Find the sample site of the checkout, or make one now."""
    for root in (Path.cwd(), Path(__file__).resolve().parents[2]):
        if (root / "sample_data" / "bodies.toml").is_file():
            return root / "sample_data" / "site.toml"
    from geofit.sample import write_site

    write_site(out / "sample_data")
    return out / "sample_data" / "site.toml"
