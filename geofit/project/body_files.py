"""Files that every implicit body leaves: its triangles as STL and VTP, and its figures as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from geofit.data.accuracy import plain
from geofit.data.files import replacing
from geofit.implicit.mesh import TriangleMesh

__all__ = ["write_figures", "write_triangles"]


def write_triangles(
    triangles: TriangleMesh, stem: Path, origin: ArrayLike = (0.0, 0.0, 0.0), *, sample: bool = False
) -> tuple[Path, ...]:
    """Write triangles as ``STEM.stl`` and ``STEM.vtp``; return the files, none if there are no triangles.

    Parameters
    ----------
    triangles : TriangleMesh
        Vertices in metres about ``origin``.
    stem : Path
        Folder and name without ending.
    origin : (3,) array_like
        Offset that turns the vertices into map coordinates, metres.
    sample : bool
        The coordinates are not those of the map: they run along the axes of an array, from the low corner of a sample.
    """
    from geofit.geometry.mesh import Mesh
    from geofit.io.export.triangles import write_stl
    from geofit.io.export.vtk import write_vtp

    count = len(triangles.triangles)
    if not count:
        return ()
    patch, uv = np.zeros(count, np.int64), np.zeros((count, 3, 2))
    mesh = Mesh(triangles.vertices, triangles.triangles, patch, uv, np.asarray(origin, float), (stem.name,))
    stl, vtp = stem.with_name(f"{stem.name}.stl"), stem.with_name(f"{stem.name}.vtp")
    write_stl({stem.name: mesh}, stl, sample=sample)
    write_vtp(mesh, vtp)
    return stl, stl.with_name(f"{stl.name}.origin.txt"), vtp


def write_figures(figures: Mapping[str, Any], path: Path) -> Path:
    """Write figures as JSON, nan as null; return the file."""
    with replacing(path) as part:
        part.write_text(
            json.dumps(plain(figures), ensure_ascii=False, indent=1, allow_nan=False) + "\n",
            encoding="utf-8",
            newline="\n",
        )
    return path
