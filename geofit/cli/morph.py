"""``geofit morph``: bodies of two or more surveys to what lies between."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from geofit.cli.app import app
from geofit.cli.console import listening, print_json, print_table, say, with_exit_code
from geofit.cli.options import Json, Out

if TYPE_CHECKING:
    from geofit.project.morph_run import MorphRun

__all__ = ["morph"]


class ModeWord(StrEnum):
    """Ways between two bodies."""

    ARRIVAL = "arrival"
    BLEND = "blend"
    PDE = "pde"


class PaceWord(StrEnum):
    """What grows evenly from frame to frame."""

    PROGRESS = "progress"
    VOLUME = "volume"
    TIME = "time"


class FilmWord(StrEnum):
    """Kinds of film."""

    GIF = "gif"
    MP4 = "mp4"
    NONE = "none"


@app.command()
@with_exit_code
def morph(
    surveys: Annotated[
        list[Path], typer.Argument(metavar="A B...", help="Closed bodies in order: STL, OBJ, PLY, TSurf, STEP solids.")
    ],
    out: Out,
    frames: Annotated[int, typer.Option(help="Number of frames, both ends included.")] = 25,
    mode: Annotated[
        ModeWord, typer.Option(help="Arrival field, linear blend, or level-set equation.")
    ] = ModeWord.ARRIVAL,
    pace: Annotated[PaceWord, typer.Option(help="What grows evenly from frame to frame.")] = PaceWord.PROGRESS,
    dates: Annotated[str | None, typer.Option(help="A date for each body, 2023-05-01,2024-04-20.")] = None,
    sd: Annotated[str | None, typer.Option(help="Standard deviation of each survey, m: 0.05,0.08.")] = None,
    cells: Annotated[int, typer.Option(help="Cells along the longest side.")] = 128,
    spacing: Annotated[float | None, typer.Option(help="Spacing of the lattice, m, in place of cells.")] = None,
    align: Annotated[bool, typer.Option("--align", help="Align A with B by principal axes (no dates).")] = False,
    seeds: Annotated[bool, typer.Option("--seeds", help="Start small balls where the front would never come.")] = False,
    step: Annotated[str | None, typer.Option(help="Frame to write as STEP: its progress (0 to 1) or its date.")] = None,
    horizon: Annotated[
        list[Path] | None, typer.Option(help="Surface that cuts the frames, for volumes by stratum; may be repeated.")
    ] = None,
    film: Annotated[FilmWord, typer.Option(help="Film of the frames; mp4 needs the program ffmpeg.")] = FilmWord.GIF,
    as_json: Json = False,
) -> int:
    """Find the bodies between two or more surveys: frames, volumes, film."""
    from geofit.data.accuracy import plain
    from geofit.io.bodies import read_body
    from geofit.io.surface_files import read_surface
    from geofit.morphing.morph import morph as between_surveys
    from geofit.project.morph_run import run_morph

    bodies = [read_body(path) for path in surveys]
    if len(bodies) < 2:
        raise typer.BadParameter("Give two bodies or more.")
    horizons = {path.stem: read_surface(path) for path in horizon or []}
    with listening() as progress:
        found = between_surveys(
            *bodies[:2], *bodies[2:], mode=mode.value, pace=pace.value, dates=dates.split(",") if dates else None,
            sd=_numbers(sd), cells=cells, spacing=spacing, align="principal" if align else None, seeds=seeds,
            names=[path.name for path in surveys], progress=progress,
        )  # fmt: skip
        for part in found.unreached:
            x, y, z = part.deepest.tolist()
            say(f"Never reached: {part.volume:.6g} m3 about ({x:.2f}, {y:.2f}, {z:.2f}); --seeds starts a ball there.")
        for part in found.vanishing:
            x, y, z = part.deepest.tolist()
            say(f"Vanishes: {part.volume:.6g} m3 about ({x:.2f}, {y:.2f}, {z:.2f}).")
        name = f"{surveys[0].stem}-{surveys[-1].stem}"
        run = run_morph(
            found, out, frames=frames, name=name, film=None if film is FilmWord.NONE else film.value,
            step=_when(step), horizons=horizons, progress=progress,
        )  # fmt: skip
    if as_json:
        print_json({**plain(run.figures()), "files": [str(file) for file in run.files]})
    else:
        _print(run)
    say(f"{len(run.files)} files in {out}: {', '.join(f.name for f in run.files if f.parent == out)}")
    return 0


def _numbers(text: str | None) -> list[float] | None:
    if text is None:
        return None
    try:
        return [float(word) for word in text.split(",")]
    except ValueError:
        raise typer.BadParameter(f"--sd {text}: give numbers with commas between them.") from None


def _when(text: str | None) -> float | str | None:
    if text is None:
        return None
    try:
        return float(text)
    except ValueError:
        return text


def _print(run: MorphRun) -> None:
    from geofit.morphing.body import GEOMETRY_ONLY

    rows = [
        (
            row.date.isoformat() if row.date else f"{row.tau:.3f}", f"{row.volume:.6g}", f"{row.area:.5g}",
            str(row.euler), str(row.components), f"{row.gain:.5g}", f"{row.loss:.5g}", f"{row.drift:.2g}",
        )
        for row in run.rows
    ]  # fmt: skip
    head = ("date" if run.morph.dates else "tau", "volume, m3", "area, m2", "Euler", "parts", "gain, m3", "loss, m3")
    print_table((*head, "drift, m3"), rows)
    for note in run.morph.notes:
        say(note)
    for change in run.morph.changes:
        say(
            f"Gain {change.gain + 0.0:.6g} m3, loss {change.loss + 0.0:.6g} m3, net {change.net + 0.0:.6g} m3"
            + (f" ± {change.net_sd:.3g}" if run.morph.sd else "")
            + (f", {change.rate:.6g} m3 a year" if run.morph.dates else "")
        )
    align = run.morph.alignment
    if align is not None and not align.applied:
        say(
            f"Alignment, not applied: best shift {align.distance:.3g} m, {align.angle:.2g} degrees, scale "
            f"{align.scale:.4g}; overlap {align.before:.3f} without, {align.after:.3f} with it."
        )
    for event in run.morph.events:
        when = event.date.isoformat() if event.date else f"tau {event.tau:.3f}"
        (parts, then), (euler, later) = event.components, event.euler
        say(f"At {when}: parts {parts} -> {then}, Euler number {euler} -> {later}")
    say(GEOMETRY_ONLY)
