"""The error that the metamorphosis raises for bodies it cannot take."""

from __future__ import annotations

from geofit.data.errors import FitError

__all__ = ["MorphError"]


class MorphError(FitError):
    """These bodies have no metamorphosis: a mesh is open, a body is empty, dates are out of order."""
