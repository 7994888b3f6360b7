"""A body made of metaballs: a field that is negative inside, of balls that can be moved, resized, added and removed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.bodies.implicit_body import OwnField
from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.medial.kernel import STIFFNESS, reach

if TYPE_CHECKING:
    from geofit.medial.ball_sums import BallCells

__all__ = ["MetaballBody"]

Floats = NDArray[np.float64]


@arguments_checked
@dataclass(frozen=True, eq=False)
class MetaballBody(OwnField):
    """The body on which the fields of metaballs sum to 1 or more.

    It is a field in the sense of :class:`geofit.implicit.Field`: (1 - sum f_i) times the mean radius over the
    stiffness, so that it is about a distance in metres near the surface.

    Parameters
    ----------
    centre : (n, 3) array
        Centres, metres.
    radius : (n,) array
        Visible radii, metres: a lone ball is the sphere of this radius.
    stiffness : float
        s of the kernel (:mod:`geofit.medial.kernel`).
    name : str
        Name.

    Raises
    ------
    SettingsError
        If the arrays do not agree, there is no ball, or a radius is not above 0.

    Examples
    --------
    >>> body = MetaballBody(np.zeros((1, 3)), np.ones(1))
    >>> body.with_ball(0, radius=2.0).value(np.array([[2.0, 0.0, 0.0]])).tolist()
    [0.0]
    """

    centre: Floats
    radius: Floats
    stiffness: float = STIFFNESS
    name: str = "metaballs"

    def __post_init__(self) -> None:
        centre, radius = np.array(self.centre, float), np.array(self.radius, float)
        if centre.ndim != 2 or centre.shape[1:] != (3,) or radius.shape != centre.shape[:1] or not len(radius):
            raise SettingsError(
                message(
                    "medial.balls-wrong-shape",
                    "Centres have shape {centres}, radii {radii}; give (n, 3) and (n,) with at least one ball.",
                    centres=centre.shape,
                    radii=radius.shape,
                )
            )
        if not (np.isfinite(centre).all() and np.isfinite(radius).all() and (radius > 0).all()):
            raise SettingsError(
                message(
                    "medial.ball-not-finite",
                    "A ball has a radius that is not above 0, or a number that is not finite; correct it.",
                )
            )
        if not self.stiffness > 0:
            raise SettingsError(
                message(
                    "medial.stiffness-not-positive",
                    "The stiffness is {stiffness}; give a number above 0.",
                    stiffness=self.stiffness,
                )
            )
        centre.flags.writeable = radius.flags.writeable = False
        object.__setattr__(self, "centre", centre)
        object.__setattr__(self, "radius", radius)

    def __repr__(self) -> str:
        return f"<MetaballBody {self.name}: {len(self)} balls>"

    def __len__(self) -> int:
        return len(self.radius)

    @property
    def balls(self) -> Floats:
        """Centres and visible radii (n, 4), metres."""
        return np.column_stack([self.centre, self.radius])

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Corners of the box that contains every ball's reach, (3,) each, metres."""
        far = reach(self.radius, self.stiffness)[:, None]
        return (self.centre - far).min(axis=0), (self.centre + far).max(axis=0)

    @cached_property
    def lipschitz(self) -> float:
        """Upper bound of the length of the gradient: the largest sum of slopes of balls that act together."""
        return self._cells.lipschitz() * self._scale

    def value(self, xyz: ArrayLike) -> Floats:
        """Return the field (n,) at points (n, 3): negative inside, zero on the surface."""
        return self._scale * (1.0 - self._cells.sums(_points(xyz))[0])

    def gradient(self, xyz: ArrayLike) -> Floats:
        """Return the gradients (n, 3) at points (n, 3); they point outwards, and vanish beyond all reaches."""
        return -self._scale * self._cells.sums(_points(xyz))[1]

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Return bounds (k,), (k,) of the field in boxes with corners (k, 3)."""
        from geofit.implicit.field import box_corners

        low, high = self._cells.range_in(*box_corners(lower, upper))
        return self._scale * (1.0 - high), self._scale * (1.0 - low)

    @property
    def field(self) -> Self:
        """The body itself."""
        return self

    @property
    def spacing(self) -> float:
        """Mean radius, metres: over about this length the surface is flat."""
        return float(self.radius.mean())

    def with_ball(self, i: int, *, centre: ArrayLike | None = None, radius: float | None = None) -> Self:
        """Return the body with ball i moved to a centre (3,), resized, or both; metres."""
        centres, radii = self.centre.copy(), self.radius.copy()
        self._require(i)
        if centre is not None:
            centres[i] = _points(np.asarray(centre, float)[None])
        if radius is not None:
            radii[i] = radius
        return replace(self, centre=centres, radius=radii)

    def without(self, i: int) -> Self:
        """Return the body without ball i."""
        self._require(i)
        return replace(self, centre=np.delete(self.centre, i, axis=0), radius=np.delete(self.radius, i))

    def plus(self, centre: ArrayLike, radius: float) -> Self:
        """Return the body with one more ball at a centre (3,), metres; it is the last one."""
        return replace(
            self,
            centre=np.vstack([self.centre, _points(np.asarray(centre, float)[None])]),
            radius=np.r_[self.radius, radius],
        )

    def _require(self, i: int) -> None:
        if not 0 <= i < len(self):
            raise SettingsError(
                message(
                    "medial.ball-unknown",
                    "There is no ball {i}; the balls are numbered from 0 to {last}.",
                    i=i,
                    last=len(self) - 1,
                )
            )

    @property
    def _scale(self) -> float:
        return float(self.radius.mean()) / self.stiffness

    @cached_property
    def _cells(self) -> BallCells:
        from geofit.medial.ball_sums import BallCells

        return BallCells(self.centre, self.radius, self.stiffness)


def _points(xyz: ArrayLike) -> Floats:
    from geofit.implicit.field import points_of

    return points_of(xyz)
