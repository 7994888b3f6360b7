"""Writing STEP with its read-back as a task with progress; without Qt, because it runs in a process of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from geofit.cad.step import Unit, write_step
from geofit.data.accuracy import ReadBack
from geofit.data.files import file_stems
from geofit.data.progress import Progress, tell
from geofit.fitting.horizon_fit import HorizonFit

__all__ = ["StepFile", "step_paths", "write_step_files"]


@dataclass(frozen=True, eq=False)
class StepFile:
    """A file that was written: where it is, its size in bytes, and what the reader found in it, a horizon."""

    path: Path
    size: int
    read_back: Mapping[str, ReadBack]


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
    surfaces: Mapping[str, HorizonFit], target: Path, unit: Unit, separate: bool, *, progress: Progress
) -> list[StepFile]:
    """Write surfaces as STEP, in one file or one each, and read every file back.

    Raises
    ------
    Cancelled
        If ``progress`` returned False between two files.
    GeofitError
        Of :func:`geofit.cad.step.write_step`; files that were ready stay.
    """
    written = []
    plan = step_paths(list(surfaces), target, separate=separate)
    for k, (path, names) in enumerate(plan.items()):
        tell(progress, path.name, k / len(plan))
        found = write_step({name: surfaces[name] for name in names}, path, unit=unit)
        written.append(StepFile(path, path.stat().st_size, found))
    return written
