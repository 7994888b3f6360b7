"""Bodies closed between horizons of a document, or between a horizon and one elevation."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from geofit.data.errors import SettingsError
from geofit.data.messages import Message, message
from geofit.data.site import Ground
from geofit.implicit.mesh import TriangleMesh
from geofit.project.body_record import BetweenHorizons, BodySource, MorphFrame
from geofit.project.mesh_body import MeshBody

__all__ = ["horizon_body", "needed_horizons"]

#: Cells of the triangles along the longest side.
CELLS = 120
#: What lies above the ground is stated if it is more than this share of what the horizons enclose.
LEAST = 1e-4


def horizon_body(
    upper: str, lower: str | float, name: str, horizons: Mapping[str, Any], ground: Ground | None = None
) -> MeshBody:
    """Return the body below one horizon and above another, or above an elevation; it ends at the ground.

    Raises
    ------
    SettingsError
        If a horizon has no surface.
    MorphError
        If the upper surface lies nowhere above the lower one, below the ground.
    """
    from geofit.morphing.between import between
    from geofit.morphing.columns import RockColumns, column_mesh

    missing = sorted(needed_horizons(BetweenHorizons(upper, lower)) - horizons.keys())
    if missing:
        raise SettingsError(
            message(
                "project.horizon-not-made",
                "These horizons have no surface yet: {names}. Fit them first.",
                names=", ".join(missing),
            )
        )
    surfaces = horizons[upper], horizons[lower] if isinstance(lower, str) else lower
    body = between(*surfaces, name=name, ground=ground)
    faces = [body.upper, body.lower] if body.ground is None else [body.upper, body.lower, body.ground]
    digest = hashlib.sha256(b"".join(np.ascontiguousarray(face.get_coeffs()).tobytes() for face in faces))
    low, high = (corner[:2] + body.origin[:2] for corner in body.bounds)
    step = float((high - low).max()) / CELLS
    x, y = (np.linspace(low[k], high[k], max(int(np.ceil((high - low)[k] / step)), 4) + 1) for k in (0, 1))
    mesh = column_mesh(RockColumns(*surfaces, ground), x, y, body.origin)
    whole = mesh if ground is None else column_mesh(RockColumns(*surfaces), x, y, body.origin)
    return MeshBody(name, body.origin, mesh, closed=body, digest=digest.hexdigest()[:16], notes=_above(whole, mesh))


def _above(whole: TriangleMesh, mesh: TriangleMesh) -> tuple[Message, ...]:
    """Return how much of what the horizons enclose lies above the ground and is left out."""
    above = whole.volume - mesh.volume
    if not above > LEAST * whole.volume:
        return ()
    text = message(
        "project.body-ends-at-ground",
        "The body ends at the ground: {volume:whole} m³ between its horizons lie above it and are left out.",
        volume=above,
    )
    return (text,)


def needed_horizons(source: BodySource) -> set[str]:
    """Return the horizons that a body is made from."""
    match source:
        case BetweenHorizons(upper, lower):
            return {upper, lower} if isinstance(lower, str) else {upper}
        case MorphFrame():
            return set().union(*(needed_horizons(end.source) for end in source.ends))
    return set()
