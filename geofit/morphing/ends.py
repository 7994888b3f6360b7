"""What a body is to a metamorphosis: a field or a closed mesh about a common local origin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import message
from geofit.implicit.field import Field, moved
from geofit.implicit.mesh import TriangleMesh
from geofit.morphing.errors import MorphError
from geofit.surfaces.mesh_surface import MeshSurface

__all__ = ["End", "ends_of", "require_closed"]

Floats = NDArray[np.float64]

#: Coordinates beyond this get a local origin of their own, metres.
FAR = 1e4
#: Edges that an error names.
NAMED = 5


@runtime_checkable
class FittedBody(Protocol):
    """A body with a field about an origin: a fitted body, or a frame of another metamorphosis."""

    @property
    def field(self) -> Field:
        """The field about the origin."""
        ...

    @property
    def origin(self) -> Floats:
        """Map coordinates (3,) of the origin."""
        ...


@dataclass(frozen=True, eq=False)
class End:
    """A body of a metamorphosis.

    Parameters
    ----------
    given : object
        The body as it was given.
    shape : Field or TriangleMesh
        The body about the common origin.
    bounds : pair of (3,) arrays
        Box that contains it.
    name : str
        Its name.
    turned : bool
        Whether it is a mesh whose normals pointed inwards: its triangles are reversed, those of ``given`` too.
    """

    given: Any
    shape: Field | TriangleMesh
    bounds: tuple[Floats, Floats]
    name: str
    turned: bool = False


def ends_of(bodies: Sequence[Any], names: Sequence[str] | None = None) -> tuple[tuple[End, ...], Floats]:
    """Return bodies about one local origin, and its map coordinates (3,).

    Errors call them by ``names``, else by their own names, else A, B, ...

    Raises
    ------
    MorphError
        If something is not a body, a mesh is open or inconsistent, or a body is empty or has no finite box.
    """
    if names is None:
        names = [str(getattr(body, "name", "") or chr(ord("A") + k)) for k, body in enumerate(bodies)]
    raw, given = [_mesh_of(body) for body in bodies], list(bodies)
    for mesh, name in zip(raw, names, strict=True):
        if isinstance(mesh, TriangleMesh):
            require_closed(mesh, name)
    turned = [isinstance(one, TriangleMesh) and one.volume < 0 for one in raw]
    for k in np.flatnonzero(turned).tolist():
        raw[k] = given[k] = TriangleMesh(raw[k].vertices, raw[k].triangles[:, ::-1])
    origin = _origin(raw)
    ends = (_end(*parts, origin) for parts in zip(given, raw, names, strict=True))
    return tuple(replace(end, turned=one) for end, one in zip(ends, turned, strict=True)), origin


def _mesh_of(body: Any) -> Any:
    """Return the triangles of a surface as a closed mesh; anything else as it is."""
    if isinstance(body, MeshSurface):
        return TriangleMesh(body.mesh.xyz, body.mesh.triangles)
    return body


def _origin(bodies: Sequence[Any]) -> Floats:
    for body in bodies:
        if not isinstance(body, TriangleMesh) and isinstance(body, FittedBody):
            return np.array(body.origin, float)
    for body in bodies:
        if isinstance(body, TriangleMesh):
            low, high = body.vertices.min(axis=0), body.vertices.max(axis=0)
        elif isinstance(body, Field):
            low, high = body.bounds
        else:
            continue
        if np.isfinite(low).all() and np.isfinite(high).all() and max(np.abs(low).max(), np.abs(high).max()) > FAR:
            return np.asarray(np.round((low + high) / 2, -2))
    return np.zeros(3)


def _end(given: Any, body: Any, name: str, origin: Floats) -> End:
    if isinstance(body, TriangleMesh):
        shape: Field | TriangleMesh = TriangleMesh(body.vertices - origin, body.triangles) if origin.any() else body
        assert isinstance(shape, TriangleMesh)
        return End(given, shape, (shape.vertices.min(axis=0), shape.vertices.max(axis=0)), name)
    if isinstance(body, FittedBody):
        field, shift = body.field, np.asarray(body.origin, float) - origin
        low, high = getattr(body, "extent", None) or field.bounds
    elif isinstance(body, Field):
        field, shift = body, -origin
        low, high = field.bounds
    else:
        raise MorphError(
            message(
                "morphing.not-a-body",
                "'{name}' is a {kind}, not a body: give an implicit field, a fitted body, a closed triangle mesh, or "
                "two horizons closed by geofit.between.",
                name=name,
                kind=type(given).__name__,
            )
        )
    shape = moved(field, shift=shift) if shift.any() else field
    low, high = np.asarray(low, float) + shift, np.asarray(high, float) + shift
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        raise MorphError(
            message(
                "morphing.body-no-box",
                "Body '{name}' has no finite box ({low} to {high}): intersect it with a bounded body.",
                name=name,
                low=low.tolist(),
                high=high.tolist(),
            )
        )
    return End(given, shape, (low, high), name)


def require_closed(mesh: TriangleMesh, name: str) -> None:
    """Refuse a mesh that bounds no body.

    Raises
    ------
    MorphError
        If the mesh is empty, or edges are open or inconsistent; the error names some of them.
    """
    if not len(mesh.triangles):
        raise MorphError(message("morphing.mesh-empty", "The mesh '{name}' has no triangles.", name=name))
    open_, wrong = mesh.boundary_edges, mesh.nonmanifold_edges
    if len(open_):
        raise MorphError(
            message(
                "morphing.mesh-open",
                "The mesh '{name}' is open: {count} edges have one triangle, such as {edges}. Close it in the program "
                "that made it.",
                name=name,
                count=len(open_),
                edges=_named(mesh, open_),
            )
        )
    if len(wrong):
        raise MorphError(
            message(
                "morphing.mesh-inconsistent",
                "The mesh '{name}' is inconsistent: at {count} edges more than two triangles meet, or two of opposite "
                "orientation, such as {edges}. Repair it in the program that made it.",
                name=name,
                count=len(wrong),
                edges=_named(mesh, wrong),
            )
        )


def _named(mesh: TriangleMesh, edges: NDArray[np.int64]) -> str:
    def place(vertex: int) -> str:
        return "({:.3f}, {:.3f}, {:.3f})".format(*mesh.vertices[vertex].tolist())

    return "; ".join(f"{a}-{b} {place(a)} to {place(b)}" for a, b in edges[:NAMED].tolist())
