"""Patches to one OpenCASCADE shell, and to one B-spline surface (paper, sec. 3.3: after the check).

OpenCASCADE is imported inside the functions: it takes seconds to load.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.cad import trimming
from geofit.cad.faces import explore, faces_of, free_loops, placement, to_geom
from geofit.data.errors import StitchError
from geofit.data.messages import Message, message
from geofit.geometry.seams import seams
from geofit.splines import bspline
from geofit.splines.patch import Patch
from geofit.surfaces.protocol import Surface

if TYPE_CHECKING:
    from cadquery import Shell

__all__ = ["one_surface", "shell", "to_shape"]

Floats = NDArray[np.float64]

#: Edges nearer than this (metres) are one edge: neighbours share their control points, so rounding is all
#: there is.
SEWING = 1e-7
#: An outline that leaves less than this (metres) of the surface outside does not trim it.
TRIM = 1e-6


def to_shape(surface: Surface) -> Shell:
    """Return the patches as one sewn cadquery shell in map coordinates, trimmed to the outline.

    The geometry stays about the surface's local origin, which is carried as the shell's placement: the
    coordinates keep their digits.

    Raises
    ------
    StitchError
        If patches do not share their edges, an edge inside the surface is free, or OpenCASCADE finds the
        shell invalid.
    """
    import cadquery

    return cadquery.Shell(shell(surface).Located(placement(surface.origin)))


def shell(surface: Surface) -> Any:
    """Return the sewn TopoDS_Shell in local coordinates; errors as :func:`to_shape`."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.TopAbs import TopAbs_SHELL
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
    if outline is not None and not exact:
        sewn = trimming.cut_along(sewn, outline)
    if sewn.IsNull():
        raise StitchError(
            message(
                "cad.outline-not-reached-at-all",
                "'{name}' covers no part of its outline; give an outline that it covers.",
                name=surface.name,
            )
        )
    faces = faces_of(sewn)
    shells = [TopoDS.Shell_s(part) for part in explore(sewn, TopAbs_SHELL)]
    if len(faces) == 1 and not shells:
        shells = [_shell_of(faces[0])]
    if len(shells) != 1 or len(faces_of(shells[0])) != len(faces):
        loose = len(faces) - sum(len(faces_of(part)) for part in shells)
        raise StitchError(_why_open(surface, len(shells) + loose))
    result = shells[0]
    if (loops := free_loops(result)) != 1:
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


def one_surface(surface: Surface) -> Patch:
    """Merge patches that make a tensor grid into one B-spline surface, for tools that want a single one.

    The seams keep the smoothness they have: a tangent seam becomes a knot of multiplicity degree - 1 (C1), a
    mere position seam one of multiplicity degree.

    Raises
    ------
    StitchError
        If the parameter ranges make no full grid, or neighbours differ in degree, knots or edge points.

    Notes
    -----
    Knot removal by least squares on Boehm's insertion matrix, accepted if it moves no control point by more
    than 1e-9 m.
    """
    patches = surface.patches
    ranges_u = sorted({patch.domain[:2] for patch in patches})
    ranges_v = sorted({patch.domain[2:] for patch in patches})
    grid = {(patch.domain[:2], patch.domain[2:]): patch for patch in patches}
    if len(grid) != len(ranges_u) * len(ranges_v) or len(grid) != len(patches) or len({p.degree for p in patches}) > 1:
        names = tuple(
            message(
                "cad.patch-domain", "{name} {domain} degree {degree}", name=p.name, domain=p.domain, degree=p.degree
            )
            for p in patches
        )
        raise StitchError(
            message(
                "cad.patches-not-a-grid",
                "The patches of '{name}' do not form a full grid of parameter ranges with one degree: "
                "{names}. Use the sewn shell instead.",
                name=surface.name,
                names=names,
            )
        )
    rational = any(patch.weights is not None for patch in patches)
    rows = []
    for range_u in ranges_u:
        strip = [grid[range_u, range_v] for range_v in ranges_v]
        rows.append(
            _join(
                [(_homogeneous(p).transpose(1, 0, 2), p.knots_v, p.knots_u) for p in strip],
                strip[0].degree[1],
            )
        )
    control, knots_u, knots_v = _join([(c.transpose(1, 0, 2), ku, kv) for c, kv, ku in rows], patches[0].degree[0])
    knots_u, control = _smooth(knots_u, control, patches[0].degree[0], ranges_u)
    knots_v, turned = _smooth(knots_v, control.transpose(1, 0, 2), patches[0].degree[1], ranges_v)
    control = turned.transpose(1, 0, 2)
    weights = control[..., 3] if rational else None
    points = control[..., :3] / control[..., 3:] if rational else control[..., :3]
    return Patch(surface.name, patches[0].degree, knots_u, knots_v, np.ascontiguousarray(points), weights)


def _homogeneous(patch: Patch) -> Floats:
    weights = np.ones(patch.control.shape[:2]) if patch.weights is None else patch.weights
    return np.concatenate([patch.control * weights[..., None], weights[..., None]], axis=2)


def _join(strip: list[tuple[Floats, Floats, Floats]], degree: int) -> tuple[Floats, Floats, Floats]:
    """Put patches behind each other along their first axis: (control, knots along, knots across)."""
    control, knots, across = strip[0]
    for following, further, other in strip[1:]:
        if knots[-1] != further[0] or not np.array_equal(across, other):
            raise StitchError(
                message(
                    "cad.knots-differ",
                    "Neighbouring patches differ in their knots (one ends at {end:g}, the next starts at {start:g}). "
                    "Only restrictions of one tensor-product surface can be merged.",
                    end=knots[-1],
                    start=further[0],
                )
            )
        if (apart := np.abs(control[-1] - following[0]).max()) > SEWING:
            raise StitchError(
                message(
                    "cad.patches-too-far-to-merge",
                    "Neighbouring patches have a gap of {apart:.3g} m; at most {limit:g} m can be merged.",
                    apart=apart,
                    limit=SEWING,
                )
            )
        control = np.concatenate([control, following[1:]])
        knots = np.concatenate([knots[:-1], further[degree + 1 :]])
    return control, knots, across


def _smooth(knots: Floats, control: Floats, degree: int, ranges: list[tuple[float, float]]) -> tuple[Floats, Floats]:
    """Remove one knot at every joint where the surface is tangent-continuous."""
    for joint, _ in ranges[1:]:
        if degree < 2:
            continue
        fewer = np.delete(knots, np.searchsorted(knots, joint))
        matrix = bspline.insertion_matrix(fewer, knots, degree)
        flat = control.reshape(len(control), -1)
        solution = np.asarray(np.linalg.lstsq(matrix, flat, rcond=None)[0], float)
        if np.abs(matrix @ solution - flat).max() <= 1e-9:
            knots, control = np.asarray(fewer, float), solution.reshape(-1, *control.shape[1:])
    return knots, control
