"""``geofit fit`` of a cloud: what it takes of the options, and what it prints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geofit.cli.console import listening, print_issues, print_json, say
from geofit.data.errors import InputError
from geofit.data.messages import message

if TYPE_CHECKING:
    from geofit.project.step_files import Signed

__all__ = ["fit_cloud_file"]


def fit_cloud_file(
    source: Path,
    out: Path,
    columns: Mapping[str, str | None],
    horizons: Sequence[str] | None,
    boundary: Path | None,
    changes: dict[str, Any],
    refused: Sequence[str],
    scheduler: str,
    workers: int | None,
    as_json: bool,
    signed: Signed,
    orientations: Path | None,
) -> int:
    """Fit one surface to a file of points that need not fit into the memory; return the exit code."""
    from geofit.fitting.conflicts import places_lost
    from geofit.io.boundary import read_boundary
    from geofit.io.clouds import open_cloud
    from geofit.io.orientations import read_orientations
    from geofit.project.cloud_run import cloud_name, run_cloud

    if refused or len(horizons or ()) > 1:
        raise InputError(
            message("cli.not-for-clouds", "{option} is not for clouds", option=refused[0] if refused else "--horizon"),
            message("cli.cloud-one-surface", "Leave it out: a cloud gives one surface over its own coordinates."),
            file=str(source),
        )
    roles = {"x": columns.get("x"), "y": columns.get("y"), "z": columns.get("z"), "horizon": columns.get("surface")}
    name = horizons[0] if horizons else None
    cloud = open_cloud(source, roles, name, columns.get("sep"), columns.get("decimal"), columns.get("unit"))
    area = None if boundary is None else read_boundary(boundary)
    dips, listed = (None, ()) if orientations is None else read_orientations(orientations, cloud_name(cloud))
    with listening() as progress:
        done = run_cloud(
            cloud, out, changes, area, progress, scheduler=scheduler, workers=workers, signed=signed, orientations=dips
        )
    print_issues(tuple(listed))
    print_issues(cloud.issues, str(out / f"{done.files[0].stem}_import_issues.csv"))
    accuracy = done.accuracy
    if as_json:
        print_json(done.figures)
        return done.exit_code
    say(
        message(
            "cli.cloud-result",
            "{name}: {n} points, sigma {sigma:.4g} m, largest {largest:.4g} m, epsilon {epsilon:g} m: {verdict}",
            name=done.fit.surface.name,
            n=done.fit.n,
            sigma=accuracy.sigma,
            largest=accuracy.max_abs,
            epsilon=accuracy.epsilon,
            verdict="PASS" if accuracy.passed else "FAIL",
        )
    )
    for note in places_lost(len(done.fit.coincident), done.fit.n, done.fit.settings.coincidence_distance):
        say(note)
    if done.dips is not None:
        say(done.dips.text)
    say(message("cli.cloud-files", "Surface, figures, grid of deviations and distances are in {folder}", folder=out))
    return done.exit_code
