"""Surfaces in every format, a project, a site file, a mapping and a workbook: each is read or ends in a geofit error.

Foreign CAD files are read in a process of their own, as geofit does for its users.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np

from geofit import PointSet, fit_horizon
from geofit.geometry.mesh import Mesh
from geofit.io import read_points, read_site, read_surfaces
from geofit.io.mapping import load_mappings
from geofit.io.project import Project, ProjectResult, open_project, save_project

__all__ = ["CAD", "READERS", "originals", "read"]

#: Each of these starts a process.
CAD = ("a.step", "a.igs", "a.brep")


def originals(folder: Path) -> dict[str, bytes]:
    """Return sound surfaces in every format, a project, a site file, a mapping and a workbook."""
    from geofit.cad.export import write_brep, write_iges
    from geofit.cad.step import write_step
    from geofit.io.export.tsurf import write_tsurf

    rng = np.random.default_rng(1)
    surface = fit_horizon(PointSet(rng.uniform(0, 100, (12, 3)) + np.array([500_000.0, 3_100_000.0, 0.0])), name="a")
    write_step({"a": surface}, folder / "a.step")
    write_iges({"a": surface}, folder / "a.igs")
    write_brep({"a": surface}, folder / "a.brep")
    mesh: Mesh = surface.triangulate(0.5)
    write_tsurf({"a": mesh}, folder / "a.ts")
    save_project(Project(name="p"), folder / "p.geofit", {"a": surface})
    (folder / "picks.csv").write_text("x,y,z\n" + "\n".join("{},{},{}".format(*row) for row in surface.points.xyz))
    (folder / "site.toml").write_text('[site]\nname = "s"\n[picks]\nfile = "picks.csv"\nhorizon = "T"\n')
    (folder / "map.toml").write_text('version = 1\n[[table]]\nfile = "picks.csv"\nkind = "picks"\n')
    names = ["a.step", "a.igs", "a.brep", "a.ts", "p.geofit", "site.toml", "map.toml"]
    with suppress(ImportError):
        import openpyxl

        book = openpyxl.Workbook()
        for row in [("x", "y", "z"), *surface.points.xyz.tolist()]:
            book.active.append(row)
        book.save(folder / "book.xlsx")
        names.append("book.xlsx")
    return {name: (folder / name).read_bytes() for name in names}


def _project(path: Path) -> None:
    """Open a damaged project and save it again: nothing but its own surfaces may be removed."""
    project = open_project(path)
    strange = ProjectResult(horizon="b", surface=r"p_surfaces/..\..\kept", sha256="")
    save_project(Project(name=project.name, results=(*project.results, strange)), path)
    save_project(Project(name=project.name), path)


READERS: dict[str, Callable[[Path], object]] = {
    "site.toml": read_site,
    "map.toml": load_mappings,
    ".step": read_surfaces,
    ".igs": read_surfaces,
    ".brep": read_surfaces,
    ".ts": read_surfaces,
    ".geofit": _project,
    ".xlsx": read_points,
}


def read(name: str, folder: Path, done: list[str], case: int) -> Counter[str]:
    """Read a damaged file; no file that is not the project's may be touched."""
    kept = folder / r"p_surfaces" / r"..\..\kept"
    kept.parent.mkdir(exist_ok=True)
    kept.write_text("somebody's")
    try:
        (READERS.get(name) or READERS[Path(name).suffix])(folder / name)
    finally:
        if not kept.is_file() or kept.read_text() != "somebody's":
            raise AssertionError(f"{name}: a file that is not the project's was touched")
    return Counter()
