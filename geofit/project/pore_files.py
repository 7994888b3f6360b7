"""What leaves a rock volume that is looked at: the files of ``geofit pores``, or its report."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from geofit.data.files import file_stems, folder_for
from geofit.data.languages import EN, Language
from geofit.data.messages import Message
from geofit.data.progress import Progress, tell, within
from geofit.project.pore_view import is_large, open_pores

if TYPE_CHECKING:
    from geofit.project.pores_run import PoresRun

__all__ = ["PoreFiles", "pore_files", "write_pore_files"]

#: Endings of the files of a network, and of the surface.
NETWORK = (
    ".json", "_pores.csv", "_throats.csv", "_face_throats.csv", "_dropped.csv", "_openpnm.json", "_node1.dat",
    "_node2.dat", "_link1.dat", "_link2.dat", "_network.vtp",
)  # fmt: skip
SURFACE = ("_surface.stl", "_surface.stl.origin.txt", "_surface.vtp")
REPORT = ("_report.html", "_report.pdf")


@dataclass(frozen=True)
class PoreFiles:
    """The files that were written, and what a reader of their figures must know."""

    files: tuple[Path, ...]
    messages: tuple[Message, ...]


def pore_files(folder: Path, name: str, shape: tuple[int, ...], *, report: bool = False) -> tuple[Path, ...]:
    """Return the files that :func:`write_pore_files` writes; a volume as large as :func:`is_large` gets no surface."""
    stem = file_stems([name])[name]
    endings = REPORT if report else (*NETWORK, *(() if is_large(shape) else SURFACE))
    return tuple(folder / f"{stem}{ending}" for ending in endings)


def write_pore_files(
    source: NDArray[Any] | Path,
    low: float,
    high: float,
    voxel: tuple[float, ...],
    folder: Path,
    name: str,
    report: bool = False,
    t: Language = EN,
    *,
    progress: Progress | None = None,
) -> PoreFiles:
    """Write the files of ``geofit pores`` for a choice of pore values, or the report alone.

    Parameters
    ----------
    source, low, high, voxel
        As for :func:`geofit.project.pore_view.pore_view`.
    folder : Path
        Created if missing. Each file is whole or absent.
    name : str
        Name of the sample: the stem of all files.
    report : bool
        Write the report, as HTML and PDF, in place of the files.
    t : Language
        Language of the report.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Raises
    ------
    InputError
        If the voxels cannot be read, or a file cannot be written.
    VolumeError
        If all voxels are pore, or none.
    SettingsError
        If a report is wanted of a volume that is too large for its surface.
    MissingDependencyError
        If the report is to be in Chinese and the machine has no font for it.
    """
    from geofit.project.pores_run import rebuild_pores, run_pores
    from geofit.project.single_reports import write_pores_report

    volume = open_pores(source, low, high, voxel)
    run: PoresRun
    if not report:
        run = run_pores(volume, folder, name, progress)
        return PoreFiles(run.files, run.messages)
    run = rebuild_pores(volume, within(progress, 0.0, 0.9))
    tell(progress, "report", 0.9)
    return PoreFiles(write_pores_report(run, name, folder_for(folder), t), run.messages)
