"""GOCAD TSurf as a surface to be checked: the triangles as they stand."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from geofit.data.errors import InputError
from geofit.data.messages import Untranslated, message
from geofit.geometry.mesh import Mesh
from geofit.io.gocad import object_name, stated_axis_units
from geofit.io.no_data import is_no_data
from geofit.io.sniff import decode
from geofit.io.source import Source
from geofit.io.units import metres_of
from geofit.surfaces.mesh_surface import MeshSurface

__all__ = ["read_tsurf"]


class _Object:
    """One TSurf while it is being read."""

    def __init__(self, name: str) -> None:
        self.name, self.down = name, False
        self.units = [1.0, 1.0, 1.0]
        self.places: list[tuple[float, float, float]] = []
        self.number: dict[str, int] = {}
        self.triangles: list[tuple[int, int, int]] = []
        self.ended = False

    def surface(self, name: str) -> MeshSurface:
        xyz = np.array(self.places) * self.units * (1.0, 1.0, -1.0 if self.down else 1.0)
        origin = np.round(xyz.min(axis=0), -2)
        triangles = np.array(self.triangles, dtype=np.int64)
        if self.down:  # the mirrored triangles keep their upper side
            triangles = triangles[:, ::-1]
        count = len(triangles)
        mesh = Mesh(xyz - origin, triangles, np.zeros(count, np.int64), np.zeros((count, 3, 2)), origin, (name,))
        return MeshSurface(mesh, name)


def read_tsurf(path: str | Path) -> dict[str, MeshSurface]:
    """Read the TSurf objects of a GOCAD file by name; units of its coordinate system become metres.

    Raises
    ------
    InputError
        If the file is missing, a vertex or triangle is damaged, or there is no triangle.
    """
    source = Source(path=Path(path))
    text, _ = decode(source.read(), source.name)
    objects: list[_Object] = []
    inside = False
    for row, line in enumerate(text.splitlines(), 1):
        words = line.split()
        key = words[0].upper() if words else ""
        if key == "GOCAD":
            inside = words[1:2] == ["TSurf"]
            if inside:
                objects.append(_Object(source.path.stem))
        elif inside:
            try:
                _take(objects[-1], key, line, words)
            except (ValueError, IndexError, KeyError):
                raise InputError(
                    message("io.tsurf-key-unreadable", "This {key} cannot be read", key=key),
                    message("io.export-tsurf-again", "Export the TSurf again."),
                    file=source.name,
                    row=row,
                    value=line[:80],
                ) from None
            except InputError as error:
                raise InputError(error.reason, error.remedy, file=source.name, row=row, value=line[:80]) from None
    cut = next((one for one in objects if not one.ended), None)
    if cut is not None and objects[0].triangles:
        raise InputError(
            message(
                "io.tsurf-without-end", "The TSurf {name} has no END: lines may be missing", name=Untranslated(cut.name)
            ),
            message("io.export-tsurf-again", "Export the TSurf again."),
            file=source.name,
        )
    found: dict[str, MeshSurface] = {}
    for one in (one for one in objects if one.triangles):
        name, k = one.name, 2
        while name in found:
            name, k = f"{one.name} {k}", k + 1
        found[name] = one.surface(name)
    if not found:
        raise InputError(
            message("io.tsurf-without-triangle", "The file contains no triangle of a TSurf"),
            message("io.export-gocad-tsurf", "Export a GOCAD TSurf."),
            file=source.name,
        )
    return found


def _take(one: _Object, key: str, line: str, words: Sequence[str]) -> None:
    """Take one line of an object."""
    if key == "END":
        one.ended = True
    elif stated := object_name(line):
        one.name = stated
    elif key == "*NAME:":
        one.name = words[1]
    elif key == "AXIS_UNIT":
        one.units = [metres_of(unit) if unit else 1.0 for unit in stated_axis_units(line)]
    elif key == "ZPOSITIVE":
        one.down = words[1].casefold() == "depth"
    elif key in ("VRTX", "PVRTX"):
        x, y, z = map(float, words[2:5])
        if not np.isfinite((x, y, z)).all():
            raise ValueError
        if is_no_data(np.array(z)):
            raise InputError(
                message("io.vertex-without-elevation", "The elevation of this vertex is a mark for 'no data'"),
                message("io.export-tsurf-without-gaps", "Export the TSurf without the triangles at it."),
            )
        one.number[words[1]] = len(one.places)
        one.places.append((x, y, z))
    elif key in ("ATOM", "PATOM"):
        one.number[words[1]] = one.number[words[2]]
    elif key == "TRGL":
        a, b, c = (one.number[word] for word in words[1:4])
        one.triangles.append((a, b, c))
