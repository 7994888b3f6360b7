"""From two or more surveys to the files of what lies between: frames, table, film, one frame as a body."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geofit.data.accuracy import plain
from geofit.data.files import file_stems, folder_for, replacing, spreadsheet_cell
from geofit.data.progress import Progress, tell
from geofit.morphing.body import GEOMETRY_ONLY, MorphBody
from geofit.project.body_files import write_figures

if TYPE_CHECKING:
    from geofit.bodies.cut import CuttingSurface
    from geofit.cad.solid_read_back import SolidReadBack
    from geofit.geometry.mesh import Mesh
    from geofit.implicit.mesh import TriangleMesh
    from geofit.morphing.sequence import Morph
    from geofit.morphing.table import FrameRow

__all__ = ["FRAME_FORMATS", "MorphRun", "morph_files", "run_morph", "stratum_volumes"]

#: Columns of the table.
COLUMNS = (
    "tau", "date", "s", "volume_m3", "area_m2", "euler", "components", "gain_m3", "loss_m3", "net_m3", "net_sd_m3",
    "rate_m3", "drift_m3", "interpolated",
)  # fmt: skip
#: Kinds of frame files.
FRAME_FORMATS = ("pvd", "stl", "obj", "glb")
#: What each of them writes next to each other, files and folders.
_WRITTEN = {"pvd": (".pvd", ""), "stl": ("_stl",), "obj": ("_obj",), "glb": (".glb", ".glb.origin.txt")}


@dataclass(frozen=True, eq=False)
class MorphRun:
    """A metamorphosis, its table, the STEP file of one frame as read back, and all files that were written."""

    morph: Morph
    rows: tuple[FrameRow, ...]
    read_back: SolidReadBack | None
    files: tuple[Path, ...]
    strata: tuple[Mapping[str, float], ...] = ()

    def figures(self) -> dict[str, Any]:
        """Return everything that the JSON file has, as plain data; metres."""
        from geofit import __version__

        m = self.morph
        align = m.alignment
        return {
            "bodies": [end.name for end in m.ends],
            "mode": m.mode,
            "pace": m.pace,
            "spacing": m.lattice.spacing,
            "note": str(GEOMETRY_ONLY),
            "notes": [note.as_data() for note in m.notes],
            "unreached": [_part(part) for part in m.unreached],
            "vanishing": [_part(part) for part in m.vanishing],
            "events": [plain(asdict(event) | {"date": _day(event.date)}) for event in m.events],
            "changes": [
                {
                    "gain": one.gain, "loss": one.loss, "net": one.net, "rate": one.rate, "gain_sd": one.gain_sd,
                    "loss_sd": one.loss_sd, "net_sd": one.net_sd, "rate_sd": one.rate_sd,
                    "parts": [
                        {"kind": part.kind, "volume": part.volume, "area": part.area, "thickness": part.thickness,
                         "centre": part.centre.tolist(), "limit": part.limit, "detected": part.detected}
                        for part in one.parts
                    ],
                }
                for one in m.changes
            ],
            "alignment": None if align is None else {
                "applied": align.applied, "shift": align.shift.tolist(), "distance": align.distance,
                "angle": align.angle, "scale": align.scale, "iou_before": align.before, "iou_after": align.after,
            },
            "frames": [asdict(row) | {"date": _day(row.date)} for row in self.rows],
            "strata": list(self.strata),
            "version": __version__,
        }  # fmt: skip


def run_morph(
    morph: Morph,
    out: Path,
    *,
    frames: int = 25,
    name: str = "morph",
    formats: Sequence[str] = FRAME_FORMATS,
    film: str | None = "gif",
    step: float | str | None = None,
    horizons: Mapping[str, CuttingSurface] | None = None,
    progress: Progress | None = None,
) -> MorphRun:
    """Write the frames of a metamorphosis, its table, a film, and one frame as a STEP solid.

    The files: ``NAME.pvd`` with ``NAME/NAME_0000.vtp``, ...; ``NAME_stl/`` and ``NAME_obj/`` with a numbered file a
    frame; ``NAME.glb``, a mesh a frame; ``NAME.csv``, the table; ``NAME.gif`` or ``.mp4``; ``NAME.json``, the figures;
    ``NAME_strata.csv`` with ``horizons``; ``NAME_TAU.step`` with ``step``.

    Parameters
    ----------
    morph : Morph
        The metamorphosis.
    out : Path
        Folder for the files; created if missing. Each file is whole or absent.
    frames : int
        Number of frames, both ends included.
    name : str
        Stem of the files.
    formats : sequence of {"pvd", "stl", "obj", "glb"}
        Which files of frames are written.
    film : {"gif", "mp4"}, optional
        Kind of film; None for none.
    step : float or str, optional
        Progress or date of the frame that becomes a STEP solid.
    horizons : mapping of str to surface, optional
        The volume of each frame is given between them.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Raises
    ------
    SettingsError
        If there are fewer than 2 frames.
    InputError
        If a file cannot be written.
    """
    from geofit.report.film import write_film

    folder = folder_for(out)
    stem = folder / file_stems([name])[name]
    rows = morph.table(frames, progress)
    bodies = morph.frames(frames)
    tell(progress, "files", 0.6)
    meshes = [_mesh(body, f"{stem.name}_{k:04d}") for k, body in enumerate(bodies)]
    files = [_table(rows, stem.with_name(f"{stem.name}.csv"))]
    for kind in formats:
        files += _WRITERS[kind](bodies, meshes, stem)
    strata: tuple[Mapping[str, float], ...] = ()
    if horizons:
        strata = tuple(stratum_volumes(body, horizons) for body in bodies)
        files.append(_strata_table(bodies, strata, stem.with_name(f"{stem.name}_strata.csv")))
    if film is not None:
        tell(progress, "film", 0.8)
        files.append(write_film(bodies, stem.with_name(f"{stem.name}.{film}")))
    read_back = None
    if step is not None:
        tell(progress, "STEP", 0.9)
        body = morph(step)
        solid = stem.with_name(f"{stem.name}_{file_stems([str(step)])[str(step)]}.step")
        read_back = body.write_step(solid)
        files.append(solid)
    figures = stem.with_name(f"{stem.name}.json")
    run = MorphRun(morph, rows, read_back, (figures, *files), strata)
    write_figures(run.figures(), figures)
    return run


def morph_files(out: Path, name: str, formats: Sequence[str] = FRAME_FORMATS, film: str | None = "gif") -> list[Path]:
    """Return the files and folders that :func:`run_morph` writes, without those of a STEP frame and of horizons."""
    endings = [".csv", ".json", *(ending for kind in formats for ending in _WRITTEN[kind])]
    stem = file_stems([name])[name]
    return [out / f"{stem}{ending}" for ending in (*endings, *([] if film is None else [f".{film}"]))]


def stratum_volumes(body: MorphBody, horizons: Mapping[str, CuttingSurface]) -> dict[str, float]:
    """Return the volume of a frame between horizons, m3, from the top down; a key names the horizons that bound it."""
    if not len(body.overview.triangles):
        return {}
    x, y = body.mesh.vertices[:, :2].T
    order = sorted(horizons, key=lambda name: -float(np.nanmean(horizons[name].elevation(x, y))))
    volumes = {_stratum(order, k): 0.0 for k in range(len(order) + 1)}
    for piece in body.cut(horizons):
        below = max((k for k, name in enumerate(order, 1) if piece.sides[name] == "below"), default=0)
        volumes[_stratum(order, below)] += piece.volume
    return volumes


def _stratum(order: Sequence[str], k: int) -> str:
    if k == 0:
        return f"above {order[0]}"
    return f"below {order[-1]}" if k == len(order) else f"{order[k - 1]} to {order[k]}"


def _mesh(body: MorphBody, name: str) -> Mesh:
    from geofit.geometry.mesh import Mesh

    local: TriangleMesh = body.overview
    count = len(local.triangles)
    patch, uv = np.zeros(count, np.int64), np.zeros((count, 3, 2))
    return Mesh(local.vertices, local.triangles, patch, uv, np.asarray(body.origin, float), (name,))


def _pvd(bodies: Sequence[MorphBody], meshes: Sequence[Mesh], stem: Path) -> list[Path]:
    from geofit.io.export.series import write_pvd

    times = [body.tau if body.date is None else float(body.date.toordinal()) for body in bodies]
    return list(write_pvd(list(zip(times, meshes, strict=True)), stem.with_name(f"{stem.name}.pvd")))


def _numbered(
    kind: str, write: Callable[[Mapping[str, Mesh], Path], object], meshes: Sequence[Mesh], stem: Path
) -> list[Path]:
    folder = folder_for(stem.with_name(f"{stem.name}_{kind}"))
    files = []
    for mesh in meshes:
        if len(mesh.triangles):
            files.append(folder / f"{mesh.names[0]}.{kind}")
            write({mesh.names[0]: mesh}, files[-1])
    return files


def _stl(bodies: Sequence[MorphBody], meshes: Sequence[Mesh], stem: Path) -> list[Path]:
    from geofit.io.export.triangles import write_stl

    return _numbered("stl", write_stl, meshes, stem)


def _obj(bodies: Sequence[MorphBody], meshes: Sequence[Mesh], stem: Path) -> list[Path]:
    from geofit.io.export.triangles import write_obj

    return _numbered("obj", write_obj, meshes, stem)


def _glb(bodies: Sequence[MorphBody], meshes: Sequence[Mesh], stem: Path) -> list[Path]:
    from geofit.io.export.triangles import write_glb

    target = stem.with_name(f"{stem.name}.glb")
    write_glb({mesh.names[0]: mesh for mesh in meshes if len(mesh.triangles)}, target)
    return [target]


_WRITERS: dict[str, Callable[[Sequence[MorphBody], Sequence[Mesh], Path], list[Path]]] = {
    "pvd": _pvd, "stl": _stl, "obj": _obj, "glb": _glb,
}  # fmt: skip


def _table(rows: Sequence[FrameRow], path: Path) -> Path:
    with replacing(path) as part, part.open("w", encoding="utf-8-sig", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(COLUMNS)
        for row in rows:
            values = asdict(row) | {"date": _day(row.date) or ""}
            writer.writerow([f"{v:.9g}" if isinstance(v, float) else v for v in values.values()])
    return path


def _strata_table(bodies: Sequence[MorphBody], strata: Sequence[Mapping[str, float]], path: Path) -> Path:
    names = list(dict.fromkeys(name for row in strata for name in row))
    with replacing(path) as part, part.open("w", encoding="utf-8-sig", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["tau", "date", *(f"{spreadsheet_cell(name)} m3" for name in names)])
        for body, row in zip(bodies, strata, strict=True):
            writer.writerow(
                [f"{body.tau:.9g}", _day(body.date) or "", *(f"{row.get(name, 0.0):.9g}" for name in names)]
            )
    return path


def _part(part: Any) -> dict[str, Any]:
    return {
        "kind": part.kind,
        "volume": part.volume,
        "deepest": part.deepest.tolist(),
        "depth": part.depth,
        "leg": part.leg,
    }


def _day(day: Any) -> str | None:
    return None if day is None else str(day.isoformat())
