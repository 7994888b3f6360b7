"""What OpenCASCADE finds in a STEP file that was written: distances, seams, validity, self-intersection."""

from __future__ import annotations

import hashlib
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.cad.faces import edge_places, edges_with_faces, faces_of, free_edges, free_loops
from geofit.cad.step_attributes import attributes_of
from geofit.data.accuracy import Check, ReadBack, Seam
from geofit.data.messages import Message, message
from geofit.geometry.one_sheet import one_sheet
from geofit.geometry.projection import Projection, project
from geofit.surfaces.protocol import FittedSurface, Surface

if TYPE_CHECKING:
    from geofit.cad.imported import FileShape

__all__ = ["attribute_check", "read_back", "self_intersects"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Limits that the file must keep: metres, metres, degrees, metres.
CORE, GAP, ANGLE, EDGE = 1e-6, 1e-6, 0.1, 1e-6
#: How far sigma measured in the file may be from the one that it states: metres, and share of it.
SIGMA, DIGITS = 1e-6, 1e-5
#: Places along every seam.
SAMPLES = 200
#: OpenCASCADE projects some 7,000 points a second: so many are left to it, of more it measures a share.
MEASURED = 2000


def read_back(
    surface: FittedSurface,
    shape: FileShape,
    found: Surface,
    written: Any,
    path: Path,
    stated: Mapping[str, str] | None = None,
) -> ReadBack:
    """Check a horizon as written in the file against the one that was written.

    Parameters
    ----------
    surface : FittedSurface
        What was written, with its points.
    shape : FileShape
        What was read, as OpenCASCADE's shape.
    found : Surface
        The same as patches, whole even where the outline trims them: points beyond it are measured as in the
        fit. Those on patches that lie wholly beyond it, and so are not in the file, are left out.
    written : TopoDS_Shell
        The shell that was handed to the writer.
    path : Path
        The file.
    stated : mapping of str to str, optional
        Attributes of the product beside those of the surface: the offset of the file's coordinates.

    Returns
    -------
    ReadBack
        With a :class:`~geofit.data.accuracy.Check` for each demand.
    """
    from OCP.BRepCheck import BRepCheck_Analyzer

    xyz, is_core = surface.points.xyz, _core(surface)
    written_here = ~_on_absent_patch(surface, shape)
    distance, how = _distances(xyz[written_here], is_core[written_here], shape, found)
    squares = float(np.sum(distance**2))
    sigma = float(np.sqrt(squares / (len(distance) - 1))) if len(distance) > 1 else float("nan")
    core = distance[is_core[written_here]]
    core_max = float(np.abs(core).max()) if core.size else float("nan")
    seams = _seams(shape)
    valid = bool(BRepCheck_Analyzer(shape.shape).IsValid())
    free, expected = free_edges(shape.shape), len(free_edges(written))
    loops, whole_loops = free_loops(shape.shape), free_loops(written)
    inner, outer = _edge_tolerances(shape.shape)
    rim = surface.settings.boundary_tolerance
    proven = one_sheet(found.patches)
    crossing = not proven and self_intersects(shape.shape)
    gap = max((seam.gap for seam in seams), default=0.0)
    angle = max((seam.angle for seam in seams), default=0.0)
    tangent = surface.settings.seam == "tangent"
    checks = (
        Check(
            "read-back core",
            core_max <= CORE if core.size else None,
            core_max,
            CORE,
            "m",
            _core_words(core.size, how, ~written_here, is_core),
        ),
        Check("read-back seam gap", gap <= GAP, gap, GAP, "m", _words(seams, "gap", "m")),
        Check(
            "read-back seam angle",
            (angle <= ANGLE) if tangent else None,
            angle,
            ANGLE,
            "deg",
            _words(seams, "angle", "°"),
        ),
        Check(
            "read-back validity",
            valid,
            float(not valid),
            0.0,
            "",
            message("cad.shape-checked", "OpenCASCADE's BRepCheck of the shape read"),
        ),
        Check(
            "read-back free edges",
            len(free) == expected and loops == whole_loops,
            float(len(free)),
            float(expected),
            "edges",
            message(
                "cad.free-edges-differ",
                "free edges: {free}, edges of the outline: {expected}, closed loops: {loops}",
                free=len(free),
                expected=expected,
                loops=loops,
            ),
        ),
        _outline_check(surface, shape, free),
        Check(
            "read-back seam tolerance",
            inner <= EDGE,
            inner,
            EDGE,
            "m",
            message(
                "cad.edge-tolerance",
                "largest tolerance of an edge between faces: a larger one could hide a gap",
            ),
        ),
        Check(
            "read-back rim tolerance",
            outer <= rim,
            outer,
            rim,
            "m",
            message(
                "cad.free-edge-tolerance",
                "largest tolerance of a free edge: how far the outline's curve may leave the surface",
            ),
        ),
        Check(
            "read-back self-intersection",
            not crossing,
            float(crossing),
            0.0,
            "",
            message(
                "cad.shell-crosses-itself",
                "OpenCASCADE's boolean argument analyser finds the shell crossing itself",
            )
            if crossing
            else message(
                "cad.height-fields-apart",
                "the faces in the file are height fields over one plane, side by side: they cannot cross",
            )
            if proven
            else message(
                "cad.shell-does-not-cross-itself",
                "OpenCASCADE's boolean argument analyser finds no self-intersection",
            ),
        ),
        _normal_check(found, seams),
        _of_sigma(attribute_check(attributes_of(surface) | dict(stated or {}), shape), surface, sigma, written_here),
    )
    return ReadBack(
        file=path.name,
        sha256=hashlib.sha256(path.read_bytes()).hexdigest(),
        faces=len(found.patches),
        sigma=sigma,
        core_max_abs=core_max,
        max_abs=float(np.abs(distance).max()) if len(distance) else float("nan"),
        seams=seams,
        brep_valid=valid,
        free_edges=len(free),
        outline_edges=expected,
        edge_tolerance=max(inner, outer),
        self_intersects=crossing,
        checks=checks,
    )


def self_intersects(shape: Any) -> bool:
    """Whether faces of a shape cross themselves or each other, by BOPAlgo_ArgumentAnalyzer.

    BRepCheck does not find a face that crosses itself.
    """
    from OCP.BOPAlgo import BOPAlgo_ArgumentAnalyzer

    analyser = BOPAlgo_ArgumentAnalyzer()
    analyser.SetShape1(shape)
    analyser.ArgumentTypeMode = False
    analyser.SmallEdgeMode = False
    analyser.SelfInterMode = True
    analyser.Perform()
    return bool(analyser.HasFaulty())


def _words(seams: tuple[Seam, ...], field: str, unit: str) -> Message:
    if not seams:
        return message("cad.face-no-seam", "one face, no seam")
    worst = max(seams, key=lambda seam: float(getattr(seam, field)))
    return message(
        "cad.seam-gap-measured",
        "{places} places on each seam ({count}); largest between {first} and {second}: {value:.2g} {unit}",
        places=SAMPLES,
        count=len(seams),
        first=worst.first,
        second=worst.second,
        value=float(getattr(worst, field)),
        unit=unit,
    )


def _core(surface: FittedSurface) -> Bools:
    """Return (n,) which points are in the core; a surface that was read has none."""
    n = len(surface.points.xyz)
    return np.asarray(surface.core if len(surface.core) == n else np.zeros(n), bool)


def _on_absent_patch(surface: FittedSurface, shape: FileShape) -> Bools:
    """Return (n,) which points lie outside the outline on a patch without a face in the file.

    From there the file's nearest face is another patch: the distance would be the gap to it.
    """
    import shapely

    xyz = surface.points.xyz
    found = np.zeros(len(xyz), bool)
    absent = [k for k, patch in enumerate(surface.patches) if patch.name not in shape.face_names]
    if surface.outline is None or not absent or not len(xyz):
        return found
    area = shapely.Polygon(surface.outline)
    shapely.prepare(area)
    outside = np.flatnonzero(~shapely.dwithin(area, shapely.points(xyz[:, :2]), CORE))
    found[outside] = np.isin(project(surface.patches, xyz[outside] - surface.origin).patch, absent)
    return found


def _core_words(count: int, how: Message, left_out: Bools, is_core: Bools) -> Message:
    if not left_out.any():
        return message(
            "cad.core-points-distance",
            "largest distance of {count} core points from the surface in the file ({how})",
            count=count,
            how=how,
        )
    return message(
        "cad.core-points-distance-left-out",
        "largest distance of {count} core points from the surface in the file ({how}); points left out because their "
        "patches lie outside the study area and are not in the file: {left}, of these in the core: {core}",
        count=count,
        how=how,
        left=int(left_out.sum()),
        core=int((left_out & is_core).sum()),
    )


def _distances(xyz: Floats, is_core: Bools, shape: FileShape, found: Surface) -> tuple[Floats, Message]:
    """Signed distances: sign and face by our projection, lengths by OpenCASCADE's in map coordinates.

    OpenCASCADE's takes faces as untrimmed: lengths to trim loops are ours.
    """
    if not len(xyz):
        return np.empty(0), message("cad.no-points", "no points")
    ours = found.project(xyz)
    distance = ours.distance.copy()
    chosen = np.arange(len(xyz))
    how = message("cad.projection-of-opencascade", "OpenCASCADE's projection")
    if len(xyz) > MEASURED:
        core = np.flatnonzero(is_core)
        spread = np.unique(np.linspace(0, len(xyz) - 1, MEASURED // 4).astype(int))
        chosen = np.unique(np.concatenate([core[:: max(1, len(core) // MEASURED)], spread]))
    if any(found.loops) and ours.beyond is not None:
        chosen = chosen[~ours.beyond[chosen]]
    length = _occ_lengths(shape, xyz, ours, chosen)
    if 0 < len(chosen) < len(xyz):
        apart = np.abs(length - np.abs(ours.distance[chosen])).max()
        how = message(
            "cad.projection-of-both",
            "{count} projected by OpenCASCADE, the others by geofit; the two agree within {apart:.1e} m",
            count=len(chosen),
            apart=float(apart),
        )
    distance[chosen] = np.where(ours.distance[chosen] < 0, -length, length)
    return distance, how


def _occ_lengths(shape: FileShape, xyz: Floats, ours: Projection, chosen: NDArray[np.int64]) -> Floats:
    """Return the distances of the chosen points from the file's faces, all by OpenCASCADE.

    Its projection may stop in a local minimum. The file's own face, evaluated by it where our projection ends, is a
    witness: no point lies farther from a face than from one place of it.
    """
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeVertex
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape
    from OCP.Extrema import Extrema_ExtAlgo
    from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_REVERSED

    length = np.empty(len(chosen))
    faces = faces_of(shape.shape.Located(shape.location))
    for index, face in enumerate(faces):
        rows = np.flatnonzero(ours.patch[chosen] == index)
        if not rows.size:
            continue
        geometry = BRep_Tool.Surface_s(face)
        bounds = geometry.Bounds()
        whole = BRepBuilderAPI_MakeFace(geometry, *bounds, 1e-7).Face()
        projector = GeomAPI_ProjectPointOnSurf()
        # Without a tree it looks at every place of its grid, for every point.
        projector.Init(geometry, *bounds, Extrema_ExtAlgo.Extrema_ExtAlgo_Tree)
        # A patch of a reversed face runs backwards in u (geofit.cad.imported).
        turned = face.Orientation() == TopAbs_REVERSED
        for row in rows:
            point = gp_Pnt(*xyz[chosen[row]].tolist())
            projector.Perform(point)
            length[row] = projector.LowerDistance() if projector.NbPoints() else np.inf
            u, v = float(ours.u[chosen[row]]), float(ours.v[chosen[row]])
            witness = geometry.Value(bounds[0] + bounds[1] - u if turned else u, v)
            length[row] = min(length[row], point.Distance(witness))
            # A foot on the edge of the face is not an orthogonal projection.
            if length[row] > abs(ours.distance[chosen[row]]) + 1e-8:
                vertex = BRepBuilderAPI_MakeVertex(point).Vertex()
                length[row] = min(length[row], BRepExtrema_DistShapeShape(vertex, whole).Value())
    return length


def _seams(shape: FileShape) -> tuple[Seam, ...]:
    """Gap and angle on every edge between two faces, each face evaluated on its own parameter curve."""
    from OCP.BRep import BRep_Tool

    names = dict(zip((hash(face) for face in faces_of(shape.shape)), shape.face_names, strict=True))
    worst: dict[tuple[str, str], tuple[float, float]] = defaultdict(lambda: (0.0, 0.0))
    for edge, faces in edges_with_faces(shape.shape):
        if len(faces) != 2:
            continue
        first, last = BRep_Tool.Range_s(edge)
        t = np.linspace(first, last, SAMPLES)
        (a, normal_a), (b, normal_b) = (_on_face(edge, face, t) for face in faces)
        gap = float(np.linalg.norm(a - b, axis=1).max())
        cosine = np.einsum("nk,nk->n", normal_a, normal_b)
        sine = np.linalg.norm(np.cross(normal_a, normal_b), axis=1)
        angle = float(np.degrees(np.arctan2(sine, cosine)).max())
        pair = names[hash(faces[0])], names[hash(faces[1])]
        worst[pair] = max(worst[pair][0], gap), max(worst[pair][1], angle)
    return tuple(Seam(*pair, gap, angle) for pair, (gap, angle) in worst.items())


def _on_face(edge: Any, face: Any, t: Floats) -> tuple[Floats, Floats]:
    """Points and unit normals of a face along one of its edges, from the edge's parameter curve on it."""
    from OCP.BRep import BRep_Tool
    from OCP.gp import gp_Pnt, gp_Vec
    from OCP.TopAbs import TopAbs_REVERSED

    curve = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 1.0)
    surface = BRep_Tool.Surface_s(face)
    point, du, dv = gp_Pnt(), gp_Vec(), gp_Vec()
    points, normals = [], []
    for value in t.tolist():
        uv = curve.Value(value)
        surface.D1(uv.X(), uv.Y(), point, du, dv)
        points.append((point.X(), point.Y(), point.Z()))
        cross = du.Crossed(dv)
        normals.append((cross.X(), cross.Y(), cross.Z()))
    normal = np.array(normals)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    return np.array(points), -normal if face.Orientation() == TopAbs_REVERSED else normal


def _edge_tolerances(shape: Any) -> tuple[float, float]:
    """Return the largest tolerance of the edges between faces, and of the free ones."""
    from OCP.BRep import BRep_Tool

    inner, outer = 0.0, 0.0
    for edge, faces in edges_with_faces(shape):
        tolerance = float(BRep_Tool.Tolerance_s(edge))
        if len(faces) == 1:
            outer = max(outer, tolerance)
        else:
            inner = max(inner, tolerance)
    return inner, outer


def _outline_check(surface: FittedSurface, shape: FileShape, free: list[Any]) -> Check:
    name, limit = "read-back outline", surface.settings.boundary_tolerance
    if surface.outline is None:
        return Check(
            name,
            None,
            0.0,
            limit,
            "m",
            message("cad.free-edges-of-patches", "not trimmed: the free edges are the patches' own"),
        )
    import shapely

    ring = shapely.LinearRing(surface.outline - surface.origin[:2])
    points = np.concatenate([edge_places(edge, 24)[:, :2] for edge in free])
    off = float(shapely.distance(ring, shapely.points(points)).max())
    follows, short = (
        message("cad.free-edges-follow-outline", "the free edges follow the outline"),
        message("cad.outline-not-reached", "the surface does not reach its whole outline"),
    )
    reach = follows if off <= limit else short
    return Check(name, True if off <= limit else None, off, limit, "m", reach)


def attribute_check(written: Mapping[str, str], shape: FileShape) -> Check:
    """Check that the product has the attributes that were written: sigma, epsilon, the hash of the data, the offset."""
    wrong = [key for key, value in written.items() if shape.attributes.get(key) != value]
    text = message(
        "cad.attributes-of-product",
        "{found} of {count} attributes of the product (sigma, epsilon, hash of the data) read as written",
        found=len(written) - len(wrong),
        count=len(written),
    )
    return Check("read-back attributes", not wrong, float(len(wrong)), 0.0, "", text)


def _of_sigma(attributes: Check, surface: FittedSurface, measured: float, here: Bools) -> Check:
    """Return the check of the attributes, failed if sigma measured in the file is not the one that the file states.

    Where the file contains the surface ``here`` alone, it is compared with sigma of these points.
    """
    if surface.accuracy is None or not np.isfinite(measured):
        return attributes
    stated = surface.accuracy.sigma
    if not here.all():
        stated = float(np.sqrt(np.sum(surface.accuracy.residuals[here] ** 2) / (here.sum() - 1)))
    if abs(measured - stated) <= SIGMA + DIGITS * stated:
        return attributes
    text = message(
        "cad.sigma-not-as-stated",
        "{found}, but sigma, {stated:.6g} m, is not that of the surface in the file: {measured:.6g} m",
        found=attributes.text,
        stated=stated,
        measured=measured,
    )
    return replace(attributes, passed=False, value=attributes.value + 1, text=text)


def _normal_check(found: Surface, seams: tuple[Seam, ...]) -> Check:
    """All normals on one side of the mean one; a fold has none such, there neighbours must not flip."""
    share = np.linspace(0.01, 0.99, 25)
    normals = []
    for patch in found.patches:
        u0, u1, v0, v1 = patch.domain
        normals.append(patch.normal(u0 + share[:, None] * (u1 - u0), v0 + share * (v1 - v0)).reshape(-1, 3))
    every = np.concatenate(normals)
    mean = every.mean(axis=0)
    least = float((every @ mean).min() / max(float(np.linalg.norm(mean)), 1e-300))
    flips = any(seam.angle > 90 for seam in seams)
    passed = True if least > 0 and not flips else (False if flips else None)
    text = {
        True: message("cad.normals-agree", "all normals lie on one side"),
        False: message("cad.normals-flip", "the normals of neighbouring faces flip"),
        None: message("cad.surface-folded", "the surface folds over: no single side, neighbours do not flip"),
    }[passed]
    return Check("read-back normals", passed, least, 0.0, "cosine", text)
