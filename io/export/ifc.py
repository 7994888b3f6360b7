"""IFC4X3: horizons as the B-spline surfaces that they are, bodies as closed solids, boreholes and adits as lines."""

from __future__ import annotations

import uuid
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from geofit import __version__
from geofit.data.errors import InputError
from geofit.data.files import replacing
from geofit.data.legible import legible, legible_keys
from geofit.data.messages import message
from geofit.data.site import Hole
from geofit.fitting.horizon_fit import HorizonFit
from geofit.io.extra import need
from geofit.splines.patch import Patch

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["write_ifc"]

#: Identifiers are made of names in this space, so that the same site gives the same bytes.
NAMESPACE = uuid.UUID("5f0f6d0e-4a0b-5d5c-9a54-6b1f1c9d3a10")
TIMESTAMP = "2000-01-01T00:00:00"
#: Coordinates nearer than this (metres) are one, for the reader.
PRECISION = 1e-6


def write_ifc(
    surfaces: Mapping[str, HorizonFit],
    path: str | PathLike[str],
    *,
    holes: Sequence[Hole] = (),
    site: str = "site",
    crs: str = "",
    tolerance: float = 0.05,
    bodies: Mapping[str, BodyFit] | None = None,
    voids: Collection[str] = (),
) -> None:
    """Write an IFC4X3 file in metres and map coordinates.

    Each horizon is an IfcGeotechnicalStratum: its representation ``Surface`` holds its patches as
    IfcBSplineSurfaceWithKnots, whole; ``FootPrint`` the outline in plan that trims them, if there is one;
    ``Body`` the triangles, trimmed, for viewers without NURBS. Each body is an IfcGeotechnicalStratum of the type SOLID
    or VOID: a closed IfcTriangulatedFaceSet, with its volumes and sigma as properties. Each hole is an IfcBorehole with
    its axis. The geometry stays about the origin of each horizon or body, which is its placement.

    Parameters
    ----------
    surfaces : mapping of str to HorizonFit
        Horizons by name.
    path : path
        The file.
    holes : sequence of Hole
        Boreholes and adits.
    site : str
        Title of the site.
    crs : str
        Label of the coordinate system; empty: none in the file.
    tolerance : float
        Largest distance in metres of the triangles from the surface of a horizon.
    bodies : mapping of str to BodyFit, optional
        Bodies by name.
    voids : collection of str
        Names of the bodies that are empty, such as karst and old workings.

    Raises
    ------
    MissingDependencyError
        If ifcopenshell is not installed.
    InputError
        If there is neither a surface, a body nor a hole, or a void is not among the bodies.
    """
    ifcopenshell = need(
        "ifcopenshell", "ifc", message("io.package-missing-for-format", "Writing {format}", format="IFC")
    )
    bodies = {} if bodies is None else bodies
    unknown = sorted(set(voids) - set(bodies))
    if unknown:
        raise InputError(
            message("io.void-no-body", "The void '{name}' is not among the bodies", name=unknown[0]),
            message("io.known-bodies", "The bodies are: {names}.", names=", ".join(bodies)),
            file=str(path),
        )
    if not surfaces and not holes and not bodies:
        raise InputError(
            message("data.no-surface", "No surface to write"),
            message("data.give-a-horizon", "Give at least one horizon."),
            file=str(path),
        )
    model = _Model(ifcopenshell, legible(site), crs)
    for name, surface in legible_keys(surfaces).items():
        model.horizon(name, surface, tolerance)
    for name, given in legible_keys({given: given for given in bodies}).items():
        model.body(name, bodies[given], void=given in voids)
    for hole in holes:
        model.hole(hole)
    model.close()
    with replacing(path) as part:
        part.write_text(model.file.to_string(), encoding="ascii", newline="\n")


class _Model:
    """The file while it is being filled."""

    def __init__(self, ifcopenshell: Any, site: str, crs: str) -> None:
        self._compress = ifcopenshell.guid.compress
        self._named: Counter[str] = Counter()
        self.file = ifcopenshell.file(schema="IFC4X3_ADD2")
        header = self.file.header.file_name
        header.name, header.time_stamp = "horizons.ifc", TIMESTAMP
        header.preprocessor_version = header.originating_system = f"geofit {__version__}"
        add = self.file
        metre = add.createIfcSIUnit(UnitType="LENGTHUNIT", Name="METRE")
        radian = add.createIfcSIUnit(UnitType="PLANEANGLEUNIT", Name="RADIAN")
        self._world = self._axes((0.0, 0.0, 0.0))
        self._context = add.createIfcGeometricRepresentationContext(None, "Model", 3, PRECISION, self._world)
        if crs:
            system = add.createIfcProjectedCRS(Name=crs)
            add.createIfcMapConversion(self._context, system, 0.0, 0.0, 0.0)
        self._surface, self._body, self._axis, self._footprint = (
            add.createIfcGeometricRepresentationSubContext(
                name, "Model", None, None, None, None, self._context, None, "MODEL_VIEW", None
            )
            for name in ("Surface", "Body", "Axis", "FootPrint")
        )
        self._project = add.createIfcProject(
            self._id("project", site),
            None,
            site,
            RepresentationContexts=[self._context],
            UnitsInContext=add.createIfcUnitAssignment([metre, radian]),
        )
        self._place = add.createIfcLocalPlacement(None, self._world)
        self._site = add.createIfcSite(self._id("site", site), None, site, ObjectPlacement=self._place)
        self._parts: list[Any] = []

    def _id(self, kind: str, name: str) -> str:
        # Holes of two campaigns may have one name; of two things with one identifier, programs keep one.
        key = f"{kind}/{name}"
        self._named[key] += 1
        turn = self._named[key]
        return str(self._compress(uuid.uuid5(NAMESPACE, key if turn == 1 else f"{key}/{turn}").hex))

    def _axes(self, place: Sequence[float]) -> Any:
        return self.file.createIfcAxis2Placement3D(self.file.createIfcCartesianPoint([float(c) for c in place]))

    def _placed(self, origin: Sequence[float]) -> Any:
        return self.file.createIfcLocalPlacement(self._place, self._axes(origin))

    def horizon(self, name: str, surface: HorizonFit, tolerance: float) -> None:
        add = self.file
        exact = add.createIfcShapeRepresentation(
            self._surface, "Surface", "AdvancedSurface", [self._patch(patch) for patch in surface.patches]
        )
        mesh = surface.triangulate(tolerance)
        faces = add.createIfcTriangulatedFaceSet(
            add.createIfcCartesianPointList3D(np.round(mesh.points, 6).tolist()),
            None,
            False,
            (mesh.triangles + 1).tolist(),
        )
        body = add.createIfcShapeRepresentation(self._body, "Body", "Tessellation", [faces])
        shapes = [exact, body]
        if surface.outline is not None:
            corners = (np.asarray(surface.outline, float) - surface.origin[:2]).tolist()
            line = add.createIfcPolyline([add.createIfcCartesianPoint(p) for p in (*corners, corners[0])])
            shapes.append(add.createIfcShapeRepresentation(self._footprint, "FootPrint", "Curve2D", [line]))
        stratum = add.createIfcGeotechnicalStratum(
            self._id("horizon", name),
            None,
            name,
            Description="Boundary surface",
            ObjectPlacement=self._placed(surface.origin.tolist()),
            Representation=add.createIfcProductDefinitionShape(None, None, shapes),
            PredefinedType="USERDEFINED",
            ObjectType="HORIZON",
        )
        self._parts.append(stratum)

    def body(self, name: str, body: BodyFit, *, void: bool) -> None:
        add, mesh = self.file, body.overview
        faces = add.createIfcTriangulatedFaceSet(
            add.createIfcCartesianPointList3D(mesh.vertices.tolist()), None, True, (mesh.triangles + 1).tolist()
        )
        shape = add.createIfcShapeRepresentation(self._body, "Body", "Tessellation", [faces])
        stratum = add.createIfcGeotechnicalStratum(
            self._id("body", name),
            None,
            name,
            ObjectPlacement=self._placed(body.origin.tolist()),
            Representation=add.createIfcProductDefinitionShape(None, None, [shape]),
            PredefinedType="VOID" if void else "SOLID",
        )
        self._parts.append(stratum)
        figures = {"volume (m3)": mesh.volume, "area (m2)": mesh.area, "epsilon (m)": body.settings.epsilon}
        if body.accuracy is not None:
            figures["sigma (m)"] = body.accuracy.sigma
        values = [
            add.createIfcPropertySingleValue(key, None, add.createIfcReal(float(value)), None)
            for key, value in figures.items()
        ]
        properties = add.createIfcPropertySet(self._id("properties", name), None, "geofit", None, values)
        add.createIfcRelDefinesByProperties(self._id("has", name), None, None, None, [stratum], properties)

    def _patch(self, patch: Patch) -> Any:
        points = [[self.file.createIfcCartesianPoint(p) for p in row] for row in patch.control.tolist()]
        values_u, count_u = np.unique(patch.knots_u, return_counts=True)
        values_v, count_v = np.unique(patch.knots_v, return_counts=True)
        arguments = [
            *patch.degree,
            points,
            "UNSPECIFIED",
            False,
            False,
            False,
            count_u.tolist(),
            count_v.tolist(),
            values_u.tolist(),
            values_v.tolist(),
            "UNSPECIFIED",
        ]
        if patch.weights is None:
            return self.file.createIfcBSplineSurfaceWithKnots(*arguments)
        return self.file.createIfcRationalBSplineSurfaceWithKnots(*arguments, patch.weights.tolist())

    def hole(self, hole: Hole) -> None:
        add, start, name = self.file, hole.xyz[0], legible(hole.name)
        line = add.createIfcPolyline([add.createIfcCartesianPoint(p) for p in (hole.xyz - start).tolist()])
        axis = add.createIfcShapeRepresentation(self._axis, "Axis", "Curve3D", [line])
        self._parts.append(
            add.createIfcBorehole(
                self._id(hole.kind, name),
                None,
                name,
                ObjectType=hole.kind,
                ObjectPlacement=self._placed(start.tolist()),
                Representation=add.createIfcProductDefinitionShape(None, None, [axis]),
            )
        )

    def close(self) -> None:
        add = self.file
        add.createIfcRelAggregates(
            self._id("rel", "project"), None, RelatingObject=self._project, RelatedObjects=[self._site]
        )
        add.createIfcRelContainedInSpatialStructure(
            self._id("rel", "site"), None, RelatedElements=self._parts, RelatingStructure=self._site
        )
