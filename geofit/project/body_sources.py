"""What bodies are fitted to, read from where it lies: logged intervals, outlines on sections, picked points."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geofit.bodies.data import BodyData, BodyIssue
from geofit.bodies.settings import BodySettings
from geofit.data.errors import GeofitError, InputError
from geofit.data.messages import Untranslated, message
from geofit.data.progress import Progress
from geofit.project.body_record import Intervals, Outlines, SurfacePicks
from geofit.project.known_sources import FileSource

if TYPE_CHECKING:
    from geofit.bodies.outlines import Outline
    from geofit.data.site import ImportIssue, Site

__all__ = [
    "SourceData",
    "data_now",
    "file_digest",
    "given_of_logs",
    "interval_codes",
    "outline_layers",
    "read_body_source",
    "site_codes",
]


@dataclass(frozen=True, eq=False)
class SourceData:
    """What a source holds: data for a fit, a hash of what it held, outlines if there are any, issues of its reader."""

    data: BodyData
    given: str
    outlines: tuple[Outline, ...] = ()
    issues: tuple[ImportIssue, ...] = ()


def read_body_source(
    source: Intervals | Outlines | SurfacePicks,
    settings: BodySettings,
    campaigns: Sequence[Any],
    folder: Path,
    progress: Progress | None = None,
    *,
    unit: str | None = None,
) -> SourceData:
    """Read what a body is fitted to; what a file has and the fit does not use is among the issues of the data.

    Parameters
    ----------
    source : Intervals, Outlines or Picks
        Its file, if any, is relative to ``folder``.
    settings : BodySettings
        ``step`` is the distance of samples along intervals and outlines.
    campaigns : sequence
        Boreholes with logs of the open site.
    folder : Path
        Folder of the open site.
    unit : str, optional
        Unit of all lengths of a file of outlines or points; else what it marks, else metres.

    Raises
    ------
    GeofitError
        As :func:`geofit.fit_body`, and the readers of the files.
    """
    match source:
        case Intervals(codes, file):
            from geofit.bodies.intervals import from_intervals

            holes = _campaigns(folder / file, progress) if file else campaigns
            return SourceData(from_intervals(holes, codes, settings.step), given_of_logs(holes))
        case Outlines(file, layers):
            from geofit.bodies.outlines import from_outlines
            from geofit.io.outlines import read_outlines

            drawn = read_outlines(folder / file, layers, unit=unit)
            data = from_outlines(drawn.outlines, settings.step)
            return SourceData(_with_issues(data, drawn.issues), _given_of(drawn.inputs), drawn.outlines, drawn.issues)
        case SurfacePicks(file):
            from geofit.io.body_points import read_body_points

            picked = read_body_points(folder / file, unit=unit)
            return SourceData(
                _with_issues(picked.data, picked.issues), file_digest(folder / file), issues=picked.issues
            )


def data_now(
    sources: Sequence[FileSource], folder: Path, *, progress: Progress | None = None
) -> dict[FileSource, tuple[str, tuple[Path, ...]]]:
    """Return the hash of what each source holds now, empty where it cannot be read, and the files that were read."""
    return {source: _held(source, folder / source.file, progress) for source in sources}


def _held(source: FileSource, file: Path, progress: Progress | None) -> tuple[str, tuple[Path, ...]]:
    try:
        match source:
            case Intervals():
                site = _site(file, progress)
                given, names = given_of_logs(site.boreholes), list(site.inputs)
            case Outlines(layers=layers):
                from geofit.io.outlines import read_outlines

                inputs = read_outlines(file, layers).inputs
                given, names = _given_of(inputs), list(inputs)
            case _:
                given, names = file_digest(file), []
    except (GeofitError, OSError):
        return "", (file,)
    return given, (file, *(file.parent / name for name in names))


def outline_layers(file: Path, *, progress: Progress | None = None) -> dict[str, int]:
    """Return the layers of a file of outlines with the number of closed lines on each; errors as its reader."""
    from geofit.io.outlines import read_outlines

    return read_outlines(file).layers


def site_codes(file: Path, *, progress: Progress) -> dict[str, int]:
    """Read the site of another file, and return the codes of its interval tables.

    Raises
    ------
    InputError
        If the file cannot be read, or its site has no interval tables.
    """
    return interval_codes(_campaigns(file, progress))


def interval_codes(campaigns: Sequence[Any]) -> dict[str, int]:
    """Return the codes of interval tables with how often each occurs, the most frequent first."""
    counts: dict[str, int] = {}
    for log in (log for campaign in campaigns for log in campaign.logs):
        for code, count in zip(*np.unique(log.code, return_counts=True), strict=True):
            if code:
                counts[str(code)] = counts.get(str(code), 0) + int(count)
    return dict(sorted(counts.items(), key=lambda item: (-item[1], item[0])))


def given_of_logs(campaigns: Sequence[Any]) -> str:
    """Return a hash of all intervals and paths that a body of logged intervals depends on."""
    digest = hashlib.sha256()
    for campaign in campaigns:
        for hole, path in campaign.paths.items():
            digest.update(hole.encode())
            for array in (path.depth, path.xyz):
                digest.update(np.ascontiguousarray(array, np.float64).tobytes())
        for log in campaign.logs:
            digest.update("\n".join([*log.hole.tolist(), *log.code.tolist()]).encode())
            for array in (log.top, log.base):
                digest.update(np.ascontiguousarray(array, np.float64).tobytes())
    return digest.hexdigest()[:16]


def _given_of(inputs: Mapping[str, str]) -> str:
    """Return a short hash of files: of one alone its own, as :func:`file_digest`."""
    if len(inputs) == 1:
        return next(iter(inputs.values()))[:16]
    return hashlib.sha256("\n".join(f"{name} {inputs[name]}" for name in sorted(inputs)).encode()).hexdigest()[:16]


def file_digest(file: Path) -> str:
    """Return a short hash of a file."""
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()[:16]


def _with_issues(data: BodyData, issues: Sequence[ImportIssue]) -> BodyData:
    """Return the data with what was found when their file was read."""
    found = tuple(
        BodyIssue(
            "file",
            message(
                "project.file-issue",
                "{file}, {number}: {reason}",
                file=Untranslated(one.file),
                number=one.row,
                reason=one.reason,
            )
            if one.row
            else message("project.file-note", "{file}: {reason}", file=Untranslated(one.file), reason=one.reason),
            used=one.severity != "error",
        )
        for one in issues
    )
    return replace(data, issues=(*found, *data.issues))


def _site(file: Path, progress: Progress | None) -> Site:
    from geofit.io.site_file import load_site

    site: Site = load_site(file, progress)
    return site


def _campaigns(file: Path, progress: Progress | None) -> Sequence[Any]:
    site = _site(file, progress)
    if not any(campaign.logs for campaign in site.boreholes):
        raise InputError(
            message("project.site-without-logs", "The site has no interval tables"),
            message("project.give-site-with-logs", "Give a site file whose [boreholes] names interval tables."),
            file=str(file),
        )
    return site.boreholes
