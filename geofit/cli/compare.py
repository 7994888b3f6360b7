"""``geofit compare``: what moved between two states of a site, and whether the earlier 90 % band held."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from geofit.cli.app import app
from geofit.cli.console import listening, print_issues, print_json, print_table, say, with_exit_code
from geofit.cli.options import Json, LanguageCode
from geofit.data.messages import Message
from geofit.data.site import ImportIssue

__all__ = ["compare"]

_STATE = "A project (*.geofit) or a site file (site.toml)"


@app.command()
@with_exit_code
def compare(
    old: Annotated[Path, typer.Argument(metavar="OLD", help=f"The earlier state. {_STATE}.")],
    new: Annotated[Path, typer.Argument(metavar="NEW", help=f"The later state. {_STATE}.")],
    out: Annotated[Path | None, typer.Option(help="Folder for maps, grids and tables; none: not written.")] = None,
    horizon: Annotated[list[str] | None, typer.Option(help="Compare this horizon only; may be repeated.")] = None,
    epsilon: Annotated[
        float | None, typer.Option(help="What counts as moved, m. Default: the control error of the later fit.")
    ] = None,
    lang: Annotated[LanguageCode, typer.Option(help="Language of the maps: English or Chinese.")] = LanguageCode.EN,
    as_json: Json = False,
) -> int:
    """Compare two states of a site: what moved, and new holes against the 90 % band of the earlier state.

    Exit code 1: the earlier band of some horizon was too narrow for what was found since; 2: a horizon could not be
    fitted.
    """
    from geofit.data.languages import language
    from geofit.project.comparing import compare_states, write_comparisons
    from geofit.report.gather import change_report
    from geofit.report.schema import enveloped

    said: list[Message] = []

    def reported(text: Message) -> None:
        said.append(text)
        say(text)

    def listed(path: Path, issues: Sequence[ImportIssue]) -> None:
        if any(issue.severity != "note" for issue in issues):
            print_issues(issues, f"geofit info {path}")

    with listening() as progress:
        found = compare_states(old, new, tuple(horizon or ()), epsilon, progress, reported=reported, listed=listed)
        files = () if out is None else write_comparisons(found, out, language(lang.value))
    if as_json:
        print_json(enveloped("comparison", {"horizons": {name: change_report(one) for name, one in found.items()}}))
    else:
        header = ("horizon", "mean, m", "largest, m", "moved", "new contacts", "inside 90 %", "residual rms, m")
        rows = []
        for name, one in found.items():
            change, test = one.change, one.test
            rms = f"{test.rms:.2f}" if test.judged else "–"
            rows.append(
                (
                    name, f"{change.mean:+.3f}", f"{change.largest:+.2f}", f"{change.share:.0%}",
                    str(len(test.contacts)), f"{test.inside} of {len(test.judged)}", rms,
                )
            )  # fmt: skip
        print_table(header, rows)
    for one in found.values():
        say(one.change.text)
        say(one.test.text)
        for note in one.notes:
            say(note)
    if files:
        say(f"Maps, grids and tables: {out}")
    if any(text.severity == "error" for text in said):
        return 2
    return 1 if any(one.test.too_narrow for one in found.values()) else 0
