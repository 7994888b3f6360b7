"""The STEP file of a body, read back by OpenCASCADE and compared with the body."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.cad.faces import explore, faces_of, free_edges, from_geom
from geofit.cad.read_back import attribute_check
from geofit.cad.solid_shapes import volume_of
from geofit.data.accuracy import Check
from geofit.data.errors import StitchError
from geofit.data.messages import message, plural_message
from geofit.implicit.mesh import TriangleMesh

if TYPE_CHECKING:
    from geofit.cad.imported import FileShape
    from geofit.geometry.mesh import Mesh
    from geofit.implicit.closed_body import ClosedBody

__all__ = ["SolidReadBack", "read_back_body"]

Floats = NDArray[np.float64]

#: Largest distance of a body in the file from its place in the map, metres.
PLACE = 1e-6
#: Largest difference of volumes between the file and the triangulated body, relative: NURBS, triangles.
VOLUME = {"nurbs": 2e-3, "triangles": 1e-6}
#: Largest difference from the volume of the body itself, relative, beyond its numerical error: flat triangles cut
#: curves short, and large ones lose thin parts.
TRUE_VOLUME = 0.02
#: Volumes from here on are written in whole cubic metres.
WHOLE = 1e5


@dataclass(frozen=True)
class SolidReadBack:
    """What an independent reader (OpenCASCADE) finds in the file of a body.

    ``grade`` is "nurbs" or "triangles". ``volume`` (m3) is that of the solids in the file, ``deviation`` the largest
    distance in metres of the file's faces from the surface of the body, ``sigma`` and ``max_abs`` are of the contacts'
    distances from the faces (nan without contacts, and for a body that is cut), ``edge_tolerance`` is the largest in
    the file, metres.
    """

    file: str
    sha256: str
    grade: str
    faces: int
    solids: int
    volume: float
    deviation: float
    sigma: float
    max_abs: float
    brep_valid: bool
    free_edges: int
    edge_tolerance: float
    checks: tuple[Check, ...]

    @property
    def passed(self) -> bool:
        """Whether every check of the file passes."""
        return all(check.passed is not False for check in self.checks)


def read_back_body(
    body: ClosedBody, target: Path, attributes: Mapping[str, str], *, nurbs: bool, trimmed: bool
) -> SolidReadBack:
    """Read the file of a body and check it: NURBS or triangles, faces trimmed or whole; and its ``attributes``."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.ShapeAnalysis import ShapeAnalysis_ShapeTolerance
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_SOLID

    from geofit.cad.solid_mesh import solid_triangles
    from geofit.cad.step import read_shapes
    from geofit.geometry.mesh_projection import nearest_on_mesh
    from geofit.geometry.projection import project

    # In the product's own coordinates: the body's local ones.
    product = read_shapes(target)[0]
    shape = product.shape
    faces = faces_of(shape)
    lacking: tuple[Check, ...] = ()
    solids = list(explore(shape, TopAbs_SOLID))
    if trimmed:
        # Places of the faces themselves: beyond its trims a surface is none of the body's.
        places = solid_triangles(shape).vertices
        residuals = np.full(1, np.nan)
        volume = sum(volume_of(solid) for solid in solids)
        free = len(free_edges(shape))
    elif nurbs:
        patches = tuple(from_geom(str(k), BRep_Tool.Surface_s(face)) for k, face in enumerate(faces, 1))
        t = np.linspace(0.0, 1.0, 17)
        places = np.concatenate(
            [p.evaluate((p.domain[0] + t * (p.domain[1] - p.domain[0]))[:, None],
                        (p.domain[2] + t * (p.domain[3] - p.domain[2]))[None]).reshape(-1, 3) for p in patches]
        )  # fmt: skip
        residuals = np.full(1, np.nan)
        if len(body.contacts):
            residuals = np.abs(project(patches, body.contacts - body.origin).distance)
        volume = sum(volume_of(solid) for solid in solids)
        free = len(free_edges(shape))
    else:
        meshes = [_triangles_of(face) for face in faces]
        places = np.concatenate([mesh.vertices for mesh in meshes])
        residuals = np.full(1, np.nan)
        if len(body.contacts):
            residuals = np.abs(nearest_on_mesh(_joined(meshes), body.contacts - body.origin).distance)
        volume = sum(mesh.volume for mesh in meshes)
        free = sum(len(mesh.boundary_edges) for mesh in meshes)
        lacking = _thin_parts(residuals, meshes)
    slope = np.linalg.norm(body.field.gradient(places), axis=1)
    deviation = float((np.abs(body.field.value(places)) / np.maximum(slope, 1e-300)).max())
    tolerances = ShapeAnalysis_ShapeTolerance()
    edge = float(tolerances.Tolerance(shape, 1, TopAbs_EDGE)) if nurbs else 0.0
    valid = bool(BRepCheck_Analyzer(shape).IsValid())
    sigma = float(np.sqrt((residuals**2).sum() / max(len(residuals) - 1, 1)))
    grade = "nurbs" if nurbs else "triangles"
    size = body.size
    best = size.volume if nurbs else body.overview.volume
    # Of the two differences, the one that is nearer to its limit.
    apart, limit = max(
        (abs(volume - best), VOLUME[grade] * best),
        (abs(volume - size.volume), size.volume_error + TRUE_VOLUME * size.volume),
        key=lambda pair: pair[0] / max(pair[1], 1e-300),
    )
    epsilon = body.epsilon
    checks = (
        Check(
            "solids",
            len(solids) > 0,
            float(len(solids)),
            1.0,
            "1",
            plural_message(
                "cad.solids-count", "{count} solid in the file", "{count} solids in the file", count=len(solids)
            ),
        ),
        # A tessellated face has no surface, which the check of a B-rep would miss.
        Check(
            "valid",
            valid if nurbs else None,
            float(valid),
            1.0,
            "1",
            message("cad.solids-valid", "OpenCASCADE finds the solids valid")
            if valid
            else message("cad.solids-invalid", "OpenCASCADE finds the solids invalid"),
        ),
        Check(
            "closed",
            free == 0,
            float(free),
            0.0,
            "1",
            message("cad.free-edges-count", "{count} free edges in the file", count=free),
        ),
        Check(
            "deviation",
            deviation <= epsilon,
            deviation,
            epsilon,
            "m",
            message(
                "cad.faces-deviation",
                "The faces of the file lie within {deviation:.3g} m of the body",
                deviation=deviation,
            ),
        ),
        _sigma_check(sigma, epsilon, nurbs=nurbs, cut=trimmed),
        *lacking,
        Check(
            "volume",
            apart <= limit,
            apart,
            limit,
            "m3",
            message(
                "cad.volume-differs",
                "The file's solids have {volume} m³, the body {best} m³",
                volume=_shown(volume),
                best=_shown(best),
            )
            if nurbs
            else message(
                "cad.triangles-volume-differs",
                "The triangles in the file enclose {volume} m³, those of the body {best} m³; with its curvature the "
                "body has {size} m³",
                volume=_shown(volume),
                best=_shown(best),
                size=_shown(size.volume),
            ),
        ),
        _place_check(body, product),
        attribute_check(attributes, product),
    )
    return SolidReadBack(
        file=str(target),
        sha256=hashlib.sha256(target.read_bytes()).hexdigest(),
        grade=grade,
        faces=len(faces),
        solids=len(solids),
        volume=volume,
        deviation=deviation,
        sigma=sigma,
        max_abs=float(residuals.max()),
        brep_valid=valid,
        free_edges=free,
        edge_tolerance=edge,
        checks=checks,
    )


def _shown(cubic_metres: float) -> int | str:
    """Return a volume for a message: whole, which is written in groups, or with six digits."""
    return round(cubic_metres) if cubic_metres >= WHOLE else f"{cubic_metres:.6g}"


def _sigma_check(sigma: float, epsilon: float, *, nurbs: bool, cut: bool) -> Check:
    """Check the contacts' distances from the faces of the file, or say why there are none.

    Triangles cut curves short by what their size makes of it: their sigma is stated, epsilon is not asked of them.
    """
    if not math.isnan(sigma):
        text = (
            message(
                "cad.contacts-sigma", "The contacts lie on the faces of the file with sigma {sigma:.3g} m", sigma=sigma
            )
            if nurbs
            else message(
                "cad.contacts-triangles-sigma",
                "The contacts lie on the triangles of the file with sigma {sigma:.3g} m: flat triangles cut curves "
                "short",
                sigma=sigma,
            )
        )
        return Check("sigma", sigma < epsilon if nurbs else None, sigma, epsilon, "m", text)
    text = (
        message(
            "cad.contacts-of-cut-body", "The body is cut: its contacts are not compared with the faces that are left"
        )
        if cut
        else message("cad.body-without-contacts", "The body has no contacts to compare with the faces of the file")
    )
    return Check("sigma", None, sigma, epsilon, "m", text)


def _thin_parts(residuals: Floats, meshes: Sequence[TriangleMesh]) -> tuple[Check, ...]:
    """Return a note if contacts lie farther from all triangles than those are long: nothing of the body is near them.

    A logged interval makes a part of its own where no other hole has the rock; if it is thinner than the cells, their
    nodes do not see it.
    """
    corners = np.concatenate([mesh.corners for mesh in meshes])
    length = float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean())
    count = int((residuals > length).sum())
    if not count:
        return ()
    text = plural_message(
        "cad.contacts-without-triangles",
        "{count} of {all} contacts lies more than {length:.3g} m from the triangles of the file ({most:.3g} m): a part "
        "of the body that is thinner than their cells has no triangles",
        "{count} of {all} contacts lie more than {length:.3g} m from the triangles of the file (up to {most:.3g} m): "
        "parts of the body that are thinner than their cells have no triangles",
        count=count,
        all=len(residuals),
        length=length,
        most=float(residuals.max()),
    )
    return (Check("thin parts", None, float(count), 0.0, "1", text),)


def _joined(meshes: Sequence[TriangleMesh]) -> Mesh:
    """Return the triangles of several faces as one mesh without parameters."""
    from geofit.geometry.mesh import Mesh

    first = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])[:-1]
    triangles = np.concatenate([mesh.triangles + k for mesh, k in zip(meshes, first.tolist(), strict=True)])
    patch = np.zeros(len(triangles), np.int64)
    points = np.concatenate([mesh.vertices for mesh in meshes])
    return Mesh(points, triangles, patch, np.zeros((len(triangles), 3, 2)), np.zeros(3), ("",))


def _place_check(body: ClosedBody, product: FileShape) -> Check:
    """Check that the file, with the offset that it states, puts the body where it is in the map."""
    part = product.location.Transformation().TranslationPart()
    off = float(np.abs(np.array([part.X(), part.Y(), part.Z()]) - body.origin).max())
    text = message(
        "cad.body-place", "With the offset in the file, the body lies {off:.2g} m from its map coordinates", off=off
    )
    return Check("place", off <= PLACE, off, PLACE, "m", text)


def _triangles_of(face: Any) -> TriangleMesh:
    from OCP.BRep import BRep_Tool
    from OCP.TopLoc import TopLoc_Location

    location = TopLoc_Location()
    found = BRep_Tool.Triangulation_s(face, location)
    if found is None:
        raise StitchError(message("cad.face-without-triangles", "A face of the file has no triangles."))
    move = location.Transformation()
    nodes = [found.Node(k).Transformed(move) for k in range(1, found.NbNodes() + 1)]
    corners = [found.Triangle(k).Get() for k in range(1, found.NbTriangles() + 1)]
    return TriangleMesh(np.array([(p.X(), p.Y(), p.Z()) for p in nodes]), np.array(corners) - 1)
