"""Writing STEP with its read-back as a task with progress; without Qt, because it runs in a process of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from geofit.cad.step import Unit, write_step
from geofit.data.accuracy import ReadBack
from geofit.data.files import file_stems
from geofit.data.languages import language
from geofit.data.progress import Progress, tell
from geofit.fitting.horizon_fit import HorizonFit

__all__ = ["Signed", "StepFile", "step_paths", "write_step_files"]


@dataclass(frozen=True, eq=False)
class StepFile:
    """A file that was written: where it is, its size in bytes, what the reader found in it, its certificate."""

    path: Path
    size: int
    read_back: Mapping[str, ReadBack]
    certificate: Path | None = None


@dataclass(frozen=True)
class Signed:
    """Who answers for a file; ``certificate`` is the language of its certificate, empty for none."""

    author: str = ""
    organisation: str = ""
    certificate: str = ""


def step_paths(names: list[str], target: Path, *, separate: bool) -> dict[Path, list[str]]:
    """Return which horizons go into which file: all into ``target``, or each into ``TARGET_HORIZON.step``.

    Examples
    --------
    >>> {path.name: names for path, names in step_paths(["T1", "T2"], Path("dam.step"), separate=True).items()}
    {'dam_T1.step': ['T1'], 'dam_T2.step': ['T2']}
    """
    if not separate or len(names) < 2:
        return {target: names}
    stems = file_stems(names)
    return {target.with_name(f"{target.stem}_{stems[name]}{target.suffix}"): [name] for name in names}


def write_step_files(
    surfaces: Mapping[str, HorizonFit],
    target: Path,
    unit: Unit,
    separate: bool,
    signed: Signed | None = None,
    *,
    progress: Progress,
) -> list[StepFile]:
    """Write surfaces as STEP, in one file or one each, and read every file back.

    With a certificate, the page goes next to each file under its name: ``dam.step`` gets ``dam_certificate.pdf``.

    Raises
    ------
    Cancelled
        If ``progress`` returned False between two files.
    GeofitError
        Of :func:`geofit.cad.step.write_step`; files that were ready stay.
    """
    written, by = [], signed or Signed()
    plan = step_paths(list(surfaces), target, separate=separate)
    for k, (path, names) in enumerate(plan.items()):
        tell(progress, path.name, k / len(plan))
        mine = {name: surfaces[name] for name in names}
        found = write_step(mine, path, unit=unit, author=by.author, organisation=by.organisation)
        page = _certified(path, mine, found, by) if by.certificate else None
        written.append(StepFile(path, path.stat().st_size, found, page))
    return written


def _certified(path: Path, surfaces: Mapping[str, HorizonFit], found: Mapping[str, ReadBack], by: Signed) -> Path:
    from geofit.report.certificate import write_certificate

    page = path.with_name(f"{path.stem}_certificate.pdf")
    epsilon = {name: surface.settings.epsilon for name, surface in surfaces.items()}
    write_certificate(
        page, path, found, epsilon, language(by.certificate), author=by.author, organisation=by.organisation
    )
    return page
