"""A body to a file: STEP solid with its read-back, triangles, block model, field. Without Qt; it runs in a process."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.data.progress import Progress, tell
from geofit.project.body_building import BodyResult
from geofit.project.mesh_body import MeshBody
from geofit.project.step_files import Signed, certified

if TYPE_CHECKING:
    from geofit.cad.solid_read_back import SolidReadBack

__all__ = ["BLOCK_ENDINGS", "TRIANGLE_ENDINGS", "BodyExport", "export_body"]

#: Endings of triangle formats; of those that hold blocks or the field, which only a fitted body has.
TRIANGLE_ENDINGS = (".stl", ".obj", ".ply", ".glb", ".vtp", ".ts")
BLOCK_ENDINGS = (".csv", ".omf", ".geoh5", ".vti")


@dataclass(frozen=True, eq=False)
class BodyExport:
    """What was written, what the reader found in a STEP file, and its certificate."""

    path: Path
    read_back: SolidReadBack | None = None
    certificate: Path | None = None


def export_body(
    result: BodyResult, name: str, target: Path, signed: Signed | None = None, colour: str = "", *, progress: Progress
) -> BodyExport:
    """Write a body in the format of the file's ending.

    Parameters
    ----------
    result : BodyResult
        The body.
    name : str
        What the file calls it.
    target : Path
        ``.step``: a solid of NURBS patches within epsilon, or of triangles where they cannot follow the body or
        nothing was fitted; ``.stl``, ``.obj``, ``.ply``, ``.glb``, ``.vtp``, ``.ts``: triangles; ``.csv``, ``.omf``,
        ``.geoh5``: block model; ``.vti``: field.
    signed : Signed, optional
        What a STEP file states, and whether it gets a certificate.
    colour : str
        Colour of the body in a STEP file, ``#rrggbb``; empty: that of the first product.

    Raises
    ------
    InputError
        If the ending is none of these, or the body has no field for blocks.
    """
    ending, fitted = target.suffix.casefold(), result.fitted
    tell(progress, "write", 0.1)
    if ending in (".step", ".stp"):
        from geofit.project.triangle_body import triangle_body

        made = result.body
        body = (
            triangle_body(made.overview, made.origin, name) if isinstance(made, MeshBody) else replace(made, name=name)
        )
        stated = (signed or Signed()).about([body.extent[0] + body.origin])
        found = body.write_step(target, **stated.fields, colour=colour)
        old = [name] if result.stale else []
        return BodyExport(target, found, certified(target, {name: found}, {name: body.epsilon}, stated, old))
    if ending in TRIANGLE_ENDINGS:
        _triangles(result, name, target)
    elif ending in BLOCK_ENDINGS and fitted is not None:
        from geofit.io.export.block_model import write_block_model
        from geofit.io.export.vti import write_vti

        (write_vti if ending == ".vti" else write_block_model)(replace(fitted, name=name), target)
    else:
        needs_field = ending in BLOCK_ENDINGS
        raise InputError(
            message("project.body-blocks", "Body '{name}' was not fitted: it has no block model", name=name)
            if needs_field
            else message("project.body-ending", "A body cannot be written as '{ending}'", ending=ending),
            message(
                "project.body-endings",
                "Name the file {names}.",
                names=", ".join((".step", *TRIANGLE_ENDINGS, *(BLOCK_ENDINGS if fitted is not None else ()))),
            ),
            file=str(target),
        )
    return BodyExport(target)


def _triangles(result: BodyResult, name: str, target: Path) -> None:
    from geofit.io.export.write import FORMATS
    from geofit.project.triangle_body import plain_mesh

    mesh = plain_mesh(result.mesh, result.body.origin, name)
    chosen = FORMATS[{".ts": "tsurf"}.get(target.suffix.casefold(), target.suffix.casefold()[1:])]
    write = getattr(import_module(f"geofit.{chosen.module}"), chosen.function)
    write(mesh if chosen.takes == "vtp" else {name: mesh}, target)
