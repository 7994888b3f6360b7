"""What is in a file, as rows of a table: ``geofit info``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geofit.data.site import Site
from geofit.surfaces.surface import HorizonSurface

__all__ = ["describe_site", "describe_surfaces"]

Floats = NDArray[np.float64]


def describe_surfaces(file: Path) -> list[tuple[str, ...]]:
    """Return a row for each surface of a file: name, patches, control points, ranges of x, y and z."""
    from geofit.geometry.mesh import MeshSurface
    from geofit.io.surface_files import read_surface_file

    rows: list[tuple[str, ...]] = []
    for name, surface in read_surface_file(file).items():
        if isinstance(surface, MeshSurface):
            size, xyz = (f"{len(surface.mesh.triangles)} triangles", f"{len(surface.mesh.points)}"), surface.mesh.xyz
        else:
            size = (str(len(surface.patches)), str(surface.control_points))
            xyz = np.concatenate([_corners(surface, i) for i in range(len(surface.patches))])
        rows.append((name, *size, *_ranges(xyz)))
    return rows


def _corners(surface: HorizonSurface, index: int) -> Floats:
    patch = surface.patches[index]
    u0, u1, v0, v1 = patch.domain
    u, v = np.meshgrid(np.linspace(u0, u1, 30), np.linspace(v0, v1, 30))
    return patch.evaluate(u, v).reshape(-1, 3) + surface.origin


def describe_site(site: Site) -> list[tuple[str, ...]]:
    """Return a row for each horizon: name, points, their kinds, ranges of x, y and z."""
    rows: list[tuple[str, ...]] = []
    for name, points in site.horizons.items():
        kinds = points.kind.tolist()
        words = ", ".join(f"{kind} {kinds.count(kind)}" for kind in dict.fromkeys(kinds))
        rows.append((name, str(len(points)), words, *_ranges(points.xyz)))
    return rows


def _ranges(xyz: Floats) -> tuple[str, str, str]:
    low, high = xyz.min(axis=0), xyz.max(axis=0)
    x, y, z = (f"{a:.1f} .. {b:.1f}" for a, b in zip(low, high, strict=True))
    return x, y, z
