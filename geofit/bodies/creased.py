"""Solids of bodies with sharp creases: NURBS solids of their smooth parts, joined and cut as the field is."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.quads import patched_surface
from geofit.data.errors import FitError, StitchError
from geofit.data.messages import message
from geofit.implicit.csg import sharp_union
from geofit.implicit.field import Field
from geofit.implicit.isosurface import isosurface
from geofit.implicit.lattice import Lattice
from geofit.implicit.mesh import TriangleMesh
from geofit.implicit.quadric import Plane

if TYPE_CHECKING:
    from geofit.bodies.implicit_body import ImplicitBody
    from geofit.cad.solid_read_back import SolidReadBack
    from geofit.cad.step_origin import StepFields

__all__ = ["creased_solid", "write_solid"]

Floats = NDArray[np.float64]

#: Cells of a part's mesh along its longest side, and the room around it as a share of that side.
CELLS = 48
ROOM = 0.05


def write_solid(body: ImplicitBody, path: str | PathLike[str], **stated: Unpack[StepFields]) -> SolidReadBack:
    """Write a body as a NURBS solid, or as triangles where that cannot be done, read it back and check it.

    ``stated`` as for :func:`geofit.cad.solid.write_body`.
    """
    from geofit.cad.solid import write_body

    try:
        if sharp_union(body.field) is not None:
            return write_body(body, path, shape=creased_solid(body), **stated)
        found = write_body(body, path, patched_surface(body).components, **stated)
        if not _lost(body, found):
            return found
        # Where two parts touch, a neck or gap may be thinner than the raster of the patches.
        reason = message(
            "bodies.contacts-off-patches",
            "The contacts lie up to {off:.3g} m from the patches: a neck or a gap there is thinner than the patches, "
            "and only triangles follow it.",
            off=found.max_abs,
        )
        return write_body(body, path, reason=str(reason), **stated)
    except (FitError, StitchError) as error:
        return write_body(body, path, reason=str(error), **stated)


def _lost(body: ImplicitBody, found: SolidReadBack) -> bool:
    """Return whether contacts miss epsilon on the patches of a file although they meet it on the body."""
    if not found.sigma >= body.epsilon:
        return False
    own = body.distance(body.contacts)
    return float(np.sqrt((own**2).sum() / max(len(own) - 1, 1))) < body.epsilon


def creased_solid(body: ImplicitBody) -> Any:
    """Return the OpenCASCADE solid of a body whose field is a sharp union, intersection or difference.

    Raises
    ------
    FitError
        If patches do not follow a part, or a part has no end.
    StitchError
        If OpenCASCADE cannot join or cut the parts.
    """
    lower, upper = body.extent
    size = 10 * float(np.linalg.norm(upper - lower))
    shape, outside = _combined(body.field, body.epsilon, size)
    if outside:
        raise _endless()
    return shape


def _combined(part: Field, epsilon: float, size: float) -> tuple[Any, bool]:
    """Return the solid of a field, and whether the field is what lies outside it."""
    from geofit.cad.boolean import common, fused, half_space, subtract_solid
    from geofit.cad.solid_shapes import patch_solid

    found = sharp_union(part)
    if found is None:
        if isinstance(part, Plane):
            return half_space(part.point, part.normal, size), False
        return patch_solid(patched_surface(_Part(part, epsilon)).components), False
    parts = [_combined(one, epsilon, size) for one in found[0]]
    inner = [shape for shape, outside in parts if not outside]
    outer = [shape for shape, outside in parts if outside]
    if not outer:
        return fused(inner), found[1]
    # What lies outside some solids, or in others, is what lies outside of the first without the others.
    shape = common(outer)
    return (subtract_solid(shape, fused(inner)) if inner else shape), not found[1]


def _endless() -> FitError:
    return FitError(
        message(
            "bodies.part-unbounded", "A part of the body is unbounded: a solid must be closed. Write triangles instead."
        )
    )


@dataclass(frozen=True, eq=False)
class _Part:
    """A smooth part of a body, as patches need it."""

    field: Field
    epsilon: float
    cut_sides: tuple[str, ...] = ()

    @cached_property
    def extent(self) -> tuple[Floats, Floats]:
        lower, upper = (np.asarray(corner, float) for corner in self.field.bounds)
        if not np.isfinite(upper - lower).all():
            raise _endless()
        room = ROOM * float((upper - lower).max())
        return lower - room, upper + room

    @cached_property
    def overview(self) -> TriangleMesh:
        lower, upper = self.extent
        spacing = float((upper - lower).max()) / CELLS
        counts = np.ceil((upper - lower) / spacing).astype(int) + 1
        return isosurface(self.field, Lattice(lower, spacing, (int(counts[0]), int(counts[1]), int(counts[2]))))
