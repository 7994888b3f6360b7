"""Patches to one OpenCASCADE shell (paper, sec. 3.3: after the check); a fold that its outline cuts may be several.

OpenCASCADE is imported inside the functions: it takes seconds to load.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.cad import trimming
from geofit.cad.faces import compound_of, explore, faces_of, free_loops, placement, to_geom
from geofit.data.errors import StitchError
from geofit.data.messages import Message, message
from geofit.geometry.seams import seams
from geofit.surfaces.protocol import Surface

if TYPE_CHECKING:
    from cadquery import Compound, Shell

__all__ = ["shell", "to_shape"]

Floats = NDArray[np.float64]

#: Edges nearer than this (metres) are one edge: neighbours share their control points, so rounding is all
#: there is.
SEWING = 1e-7
#: An outline that leaves less than this (metres) of the surface outside does not trim it.
TRIM = 1e-6


def to_shape(surface: Surface) -> Shell | Compound:
    """Return the patches as one sewn cadquery shell in map coordinates, trimmed to the outline.

    The outline may cut a fold, or a surface over its best plane, into pieces: then a compound of shells.

    The geometry stays about the surface's local origin, which is carried as the shell's placement: the
    coordinates keep their digits.

    Raises
    ------
    StitchError
        If patches do not share their edges, an edge inside the surface is free, or OpenCASCADE finds the
        shell invalid.
    """
    import cadquery
    from OCP.TopAbs import TopAbs_SHELL

    sewn = shell(surface).Located(placement(surface.origin))
    return cadquery.Shell(sewn) if sewn.ShapeType() == TopAbs_SHELL else cadquery.Compound(sewn)


def shell(surface: Surface) -> Any:
    """Return the sewn TopoDS_Shell, or a compound of several, in local coordinates; errors as :func:`to_shape`."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.TopAbs import TopAbs_FACE, TopAbs_SHELL
    from OCP.TopoDS import TopoDS

    if not surface.patches:
        raise StitchError(
            message("cad.no-patch", "'{name}' has no patch; a surface needs at least one.", name=surface.name)
        )
    sewing = BRepBuilderAPI_Sewing(SEWING)
    outline = trimming.needed(surface, TRIM)
    exact = trimming.is_height_field(surface)
    for patch in surface.patches:
        if outline is not None and exact:
            pieces = trimming.faces(patch, outline)
        else:
            pieces = [BRepBuilderAPI_MakeFace(to_geom(patch), SEWING).Face()]
        for face in pieces:
            sewing.Add(face)
    sewing.Perform()
    sewn = sewing.SewedShape()
    if cut := outline is not None and not exact:
        sewn = trimming.cut_along(sewn, outline)
    if sewn.IsNull() or not faces_of(sewn):
        raise StitchError(
            message(
                "cad.outline-not-reached-at-all",
                "'{name}' covers no part of its outline; give an outline that it covers.",
                name=surface.name,
            )
        )
    shells = [TopoDS.Shell_s(part) for part in explore(sewn, TopAbs_SHELL)]
    shells += [_shell_of(face) for face in explore(sewn, TopAbs_FACE, TopAbs_SHELL)]
    # A fold may leave the study area and enter it again: in pieces, or with a hole where it bulges out of the area.
    if len(shells) > 1 and not cut:
        raise StitchError(_why_open(surface, len(shells)))
    result = shells[0] if len(shells) == 1 else compound_of(shells)
    if (loops := free_loops(result)) != 1 and not (cut and loops > 1):
        raise StitchError(
            message(
                "cad.shell-has-holes",
                "'{name}': the free edges of the sewn shell make {loops} loops; the outer boundary alone makes "
                "one. {reason}",
                name=surface.name,
                loops=loops,
                reason=_why_open(surface, 1),
            )
        )
    if not BRepCheck_Analyzer(result).IsValid():
        raise StitchError(
            message(
                "cad.shell-invalid",
                "OpenCASCADE finds the sewn shell of '{name}' invalid (BRepCheck). Look for collapsed edges or "
                "patches folded onto themselves; fit again with fewer control points or another frame.",
                name=surface.name,
            )
        )
    return result


def _shell_of(face: Any) -> Any:
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Shell

    result, builder = TopoDS_Shell(), BRep_Builder()
    builder.MakeShell(result)
    builder.Add(result, face)
    return result


def _why_open(surface: Surface, shells: int) -> Message:
    open_seams = [seam for seam in seams(surface.patches) if seam.gap > SEWING]
    if open_seams:
        places = tuple(
            message(
                "cad.seam-gap",
                "{first} and {second} have a gap of {gap:.3g} m",
                first=s.first,
                second=s.second,
                gap=s.gap,
            )
            for s in open_seams
        )
        return message(
            "cad.edges-not-shared",
            "Patches of '{name}' do not share their edges: {places}. At most {limit:g} m is needed: give neighbours "
            "the same edge row of control points.",
            name=surface.name,
            places=places,
            limit=SEWING,
        )
    return message(
        "cad.patches-not-connected",
        "The patches of '{name}' ({names}) make {shells} separate pieces; one connected surface is needed. Check the "
        "outline, and that neighbours run along whole edges.",
        name=surface.name,
        names=tuple(patch.name for patch in surface.patches),
        shells=shells,
    )
