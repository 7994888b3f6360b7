"""Weighted points, and their normal equations on one space after the other."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from geofit.data.long_arrays import Rows
from geofit.fitting.density import CLOUD
from geofit.splines.sums import Moments
from geofit.splines.tensor import TensorSpace

__all__ = ["WeightedPoints"]

Floats = NDArray[np.float64]


@dataclass(eq=False)
class WeightedPoints:
    """Values, (n,) or (n, k), at (n, 2) places, with weights (n,).

    A cloud takes long to go through: it is summed once for several spaces.
    """

    plane: Rows
    value: Rows
    weight: Floats
    _foreseen: tuple[TensorSpace, ...] = field(default=(), init=False)
    _moments: Moments | None = field(default=None, init=False)

    def foresee(self, spaces: Iterable[TensorSpace]) -> None:
        """Sum a cloud, when next it is, for these spaces as well."""
        self._foreseen = tuple(spaces)

    def equations(self, space: TensorSpace, turned: bool = False) -> tuple[Floats, Floats]:
        """Return the normal equations (:meth:`TensorSpace.normal_equations`); ``turned``, with u and v exchanged."""
        if len(self.plane) <= CLOUD or self.value.ndim > 1:
            plane = self.plane[:, ::-1] if turned else self.plane
            return space.normal_equations(plane, self.value, self.weight)
        own = space.turned if turned else space
        if self._moments is None or not self._moments.serve(own.knots_u, own.knots_v):
            spaces = (own, *self._foreseen)
            lines_u = np.unique(np.concatenate([one.knots_u for one in spaces]))
            lines_v = np.unique(np.concatenate([one.knots_v for one in spaces]))
            self._moments = Moments.of(lines_u, lines_v, own.degree, self.plane, self.value, self.weight)
        moments = self._moments.turned if turned else self._moments
        return space.equations(moments.on(space.knots_u, space.knots_v))
