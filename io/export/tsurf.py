"""GOCAD TSurf: triangles of horizons, map coordinates, elevation positive upwards."""

from __future__ import annotations

import re
from collections.abc import Mapping
from os import PathLike

from geofit.data.files import replacing
from geofit.data.legible import legible_keys
from geofit.geometry.mesh import Mesh

__all__ = ["write_tsurf"]


def write_tsurf(meshes: Mapping[str, Mesh], path: str | PathLike[str]) -> None:
    """Write one TSurf object a horizon, coordinates to 1e-6 m."""
    lines: list[str] = []
    for name, mesh in legible_keys(meshes).items():
        title = re.sub(r"[{}\s\x00-\x1f]+", " ", name).strip()
        lines += [
            "GOCAD TSurf 1",
            "HEADER {",
            f"name:{title}",
            "}",
            "GOCAD_ORIGINAL_COORDINATE_SYSTEM",
            "NAME Default",
            'AXIS_NAME "X" "Y" "Z"',
            'AXIS_UNIT "m" "m" "m"',
            "ZPOSITIVE Elevation",
            "END_ORIGINAL_COORDINATE_SYSTEM",
            "TFACE",
        ]
        lines += [f"VRTX {k} {x:.6f} {y:.6f} {z:.6f}" for k, (x, y, z) in enumerate(mesh.xyz.tolist(), 1)]
        lines += [f"TRGL {a} {b} {c}" for a, b, c in (mesh.triangles + 1).tolist()]
        lines.append("END")
    with replacing(path) as part:
        part.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
