"""The files next to a project file: surfaces as STEP, triangles of bodies as PLY, named by their hashes."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import uuid4

import numpy as np

from geofit.data.errors import InputError
from geofit.data.files import file_stems, folder_for

if TYPE_CHECKING:
    from geofit.fitting.horizon_fit import HorizonFit
    from geofit.implicit.mesh import TriangleMesh

__all__ = ["BODY_FILE", "SURFACE_FILE", "file_folder", "sha256_of", "write_body_file", "write_surface_file"]

#: Names of the files, on every system: no separator, no drive, nothing hidden.
SURFACE_FILE = re.compile(r"[^./\\:\0][^/\\:\0]*-[0-9a-f]{8}\.step")
BODY_FILE = re.compile(r"[^./\\:\0][^/\\:\0]*-[0-9a-f]{8}\.ply")


def file_folder(target: Path) -> Path:
    """Return the folder of a project's surfaces and bodies."""
    return target.with_name(f"{target.stem}_surfaces")


def write_surface_file(name: str, surface: HorizonFit, target: Path) -> tuple[str, str]:
    """Write a surface for a project; return its path from the project file, and its SHA-256."""
    from geofit.cad.step import store_step

    return _stored(name, target, ".step", lambda draft: store_step({name: surface}, draft))


def write_body_file(name: str, mesh: TriangleMesh, target: Path) -> tuple[str, str]:
    """Write the triangles (map coordinates, double precision) of a body; return path and SHA-256."""
    from geofit.geometry.mesh import Mesh
    from geofit.io.export.triangles import write_ply

    count = len(mesh.triangles)
    patch, uv = np.zeros(count, np.int64), np.zeros((count, 3, 2))
    drawn = Mesh(mesh.vertices, mesh.triangles, patch, uv, np.zeros(3), (name,))
    return _stored(name, target, ".ply", lambda draft: write_ply({name: drawn}, draft))


def sha256_of(file: Path) -> str:
    """Return the SHA-256 of a file."""
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _stored(name: str, target: Path, ending: str, write: Callable[[Path], object]) -> tuple[str, str]:
    folder, stem = folder_for(file_folder(target)), file_stems([name])[name]
    # Its own name, and a short one: another window may save the same project.
    draft = folder / f".{uuid4().hex[:8]}.draft{ending}"
    try:
        write(draft)
        digest = sha256_of(draft)
        final = folder / f"{stem}-{digest[:8]}{ending}"
        draft.replace(final)
    except InputError as error:
        raise InputError(error.reason, error.remedy, file=str(target)) from None
    finally:
        draft.unlink(missing_ok=True)
    return f"{folder.name}/{final.name}", digest
