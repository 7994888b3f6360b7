"""From a rock volume to the files of the metaballs that cover its pores."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geofit.data.accuracy import plain
from geofit.data.files import file_stems, folder_for, replacing
from geofit.data.progress import Progress, tell
from geofit.project.body_files import write_figures, write_triangles

if TYPE_CHECKING:
    from geofit.medial.fit import FittedMetaballs
    from geofit.pores.volume import RockVolume

__all__ = ["MetaballsRun", "run_metaballs"]


@dataclass(frozen=True, eq=False)
class MetaballsRun:
    """Metaballs of a volume, the volume within their triangles (m3), and the files that were written."""

    body: FittedMetaballs
    volume_of_triangles: float
    files: tuple[Path, ...]

    def figures(self) -> dict[str, Any]:
        """Return everything that the JSON file has, as plain data; lengths in metres.

        ``volume`` is that of the voxels whose middle lies within the surface, ``volume_of_triangles`` that of its
        files.
        """
        from geofit import __version__

        return {
            "shape": plain(self.body.volume.shape),
            "voxel": plain(self.body.volume.voxel),
            "balls": len(self.body.radius),
            "stiffness": self.body.stiffness,
            "candidates": self.body.candidates,
            "evaluations": self.body.evaluations,
            **plain(self.body.figures),
            "volume_of_triangles": self.volume_of_triangles,
            "version": __version__,
        }


def run_metaballs(
    volume: RockVolume, out: Path, name: str, *, max_balls: int | None = None, progress: Progress | None = None
) -> MetaballsRun:
    """Cover a volume by metaballs; write ``NAME_balls.csv``, ``NAME_metaballs.stl``, ``.vtp`` and ``.json``.

    Parameters
    ----------
    volume : RockVolume
        The voxels.
    out : Path
        Folder for the files; created if missing. Each file is whole or absent.
    name : str
        Name of the sample: the stem of all files.
    max_balls : int, optional
        As for :func:`geofit.metaballs`.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Raises
    ------
    SettingsError
        If ``max_balls`` is out of its range.
    InputError
        If a file cannot be written.
    """
    from geofit.medial.fit import metaballs

    stem = folder_for(out) / file_stems([name])[name]
    body = metaballs(volume, max_balls=max_balls, progress=progress)
    tell(progress, "files", 1.0)
    table, figures = stem.with_name(f"{stem.name}_balls.csv"), stem.with_name(f"{stem.name}_metaballs.json")
    with replacing(table) as part, part.open("w", encoding="utf-8", newline="") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(("axis0_m", "axis1_m", "axis2_m", "radius_m"))
        rows.writerows([f"{value:.9g}" for value in ball] for ball in body.balls.tolist())
    mesh = body.triangulate(volume.unit)
    triangles = write_triangles(mesh, stem.with_name(f"{stem.name}_metaballs"), sample=True)
    run = MetaballsRun(body, mesh.volume, (figures, table, *triangles))
    write_figures(run.figures(), figures)
    return run
