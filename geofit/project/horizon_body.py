"""Bodies closed between horizons of a document, or between a horizon and one elevation."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from geofit.data.errors import SettingsError
from geofit.data.messages import message
from geofit.project.body_record import BetweenHorizons, BodySource, MorphFrame
from geofit.project.mesh_body import MeshBody

__all__ = ["horizon_body", "needed_horizons"]

#: Cells of the triangles along the longest side.
CELLS = 120


def horizon_body(upper: str, lower: str | float, name: str, horizons: Mapping[str, Any]) -> MeshBody:
    """Return the body below one horizon and above another, or above an elevation; its triangles are for drawing.

    Raises
    ------
    SettingsError
        If a horizon has no surface.
    MorphError
        If the upper surface lies nowhere above the lower one.
    """
    from geofit.implicit.isosurface import isosurface
    from geofit.implicit.lattice import Lattice
    from geofit.morphing.between import between

    missing = sorted(needed_horizons(BetweenHorizons(upper, lower)) - horizons.keys())
    if missing:
        raise SettingsError(
            message(
                "project.horizon-not-made",
                "These horizons have no surface yet: {names}. Fit them first.",
                names=", ".join(missing),
            )
        )
    body = between(horizons[upper], horizons[lower] if isinstance(lower, str) else lower, name=name)
    digest = hashlib.sha256(b"".join(np.ascontiguousarray(s.get_coeffs()).tobytes() for s in (body.upper, body.lower)))
    mesh = isosurface(body, Lattice.around(*body.bounds, cells=CELLS), capped=True)
    return MeshBody(name, body.origin, mesh, closed=body, digest=digest.hexdigest()[:16])


def needed_horizons(source: BodySource) -> set[str]:
    """Return the horizons that a body is made from."""
    match source:
        case BetweenHorizons(upper, lower):
            return {upper, lower} if isinstance(lower, str) else {upper}
        case MorphFrame():
            return set().union(*(needed_horizons(end.source) for end in source.ends))
    return set()
