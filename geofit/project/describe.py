"""What is in a file, as rows of a table: ``geofit info``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geofit.data.site import Site
from geofit.surfaces.protocol import Surface

__all__ = ["Value", "describe_site", "describe_surfaces", "describe_tables"]

Floats = NDArray[np.float64]
#: A text, a number, a range from low to high, or None where it is not known.
Value = str | int | float | tuple[float, float] | None


def describe_surfaces(file: Path) -> list[tuple[Value, ...]]:
    """Return a row for each surface of a file: name, patches, control points, ranges of x, y and z."""
    from geofit.io.surface_files import read_surfaces

    rows: list[tuple[Value, ...]] = []
    for name, surface in read_surfaces(file).items():
        if surface.patches:
            poles = sum(patch.control.shape[0] * patch.control.shape[1] for patch in surface.patches)
            size: tuple[Value, Value] = (len(surface.patches), poles)
            xyz = np.concatenate([_corners(surface, i) for i in range(len(surface.patches))])
            if surface.outline is not None or any(getattr(surface, "trim_loops", ())):
                # Patches run on beyond the outline that trims them.
                xyz = surface.triangulate().xyz
        else:
            mesh = surface.triangulate()
            size, xyz = (f"{len(mesh.triangles)} triangles", len(mesh.points)), mesh.xyz
        rows.append((name, *size, *_ranges(xyz)))
    return rows


def describe_tables(file: Path) -> list[tuple[Value, ...]]:
    """Return a row for each table of a file that is not one table of points alone: name, kind, confidence, rows, roles.

    Raises
    ------
    InputError
        If the file is missing, empty or damaged.
    """
    from geofit.io.preview import preview_file

    previews = preview_file(file)
    if len(previews) == 1 and previews[0].kind in ("", "picks"):
        return []
    return [
        (
            one.table or one.file, one.kind or "not recognized", round(one.confidence, 2), one.read or None,
            ", ".join(f"{role.role} = {role.column}" for role in one.roles),
        )
        for one in previews
    ]  # fmt: skip


def _corners(surface: Surface, index: int) -> Floats:
    patch = surface.patches[index]
    u0, u1, v0, v1 = patch.domain
    u, v = np.meshgrid(np.linspace(u0, u1, 30), np.linspace(v0, v1, 30))
    return patch.evaluate(u, v).reshape(-1, 3) + surface.origin


def describe_site(site: Site) -> list[tuple[Value, ...]]:
    """Return a row for each horizon: name, points, their kinds, ranges of x, y and z."""
    rows: list[tuple[Value, ...]] = []
    for name, points in site.horizons.items():
        kinds = points.kind.tolist()
        words = ", ".join(f"{kind} {kinds.count(kind)}" for kind in dict.fromkeys(kinds))
        rows.append((name, len(points), words, *_ranges(points.xyz)))
    return rows


def _ranges(xyz: Floats) -> tuple[tuple[float, float], ...]:
    return tuple(zip(xyz.min(axis=0).tolist(), xyz.max(axis=0).tolist(), strict=True))
