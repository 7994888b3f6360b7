"""Planes and quadrics: f = X^T Q X with X = (x, y, z, 1), their 17 types, and the quadric nearest to points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import FitError, SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.field import Box, box_corners, box_of, points_of

__all__ = ["Plane", "Quadric", "ellipsoid", "fit_quadric", "quadric_from_coefficients"]

Floats = NDArray[np.float64]

#: Eigenvalues and residuals below this part of the largest count as zero in the classification.
ZERO = 1e-9
EVERYWHERE = (np.full(3, -np.inf), np.full(3, np.inf))

#: (positive, negative) eigenvalues of the quadratic part and of Q, the larger count of the first one first.
KINDS = {
    ((3, 0), (3, 1)): "ellipsoid",
    ((3, 0), (4, 0)): "imaginary ellipsoid",
    ((2, 1), (2, 2)): "hyperboloid of one sheet",
    ((2, 1), (3, 1)): "hyperboloid of two sheets",
    ((2, 1), (2, 1)): "cone",
    ((3, 0), (3, 0)): "imaginary cone",
    ((2, 0), (3, 1)): "elliptic paraboloid",
    ((1, 1), (2, 2)): "hyperbolic paraboloid",
    ((2, 0), (2, 1)): "elliptic cylinder",
    ((2, 0), (3, 0)): "imaginary elliptic cylinder",
    ((1, 1), (2, 1)): "hyperbolic cylinder",
    ((1, 1), (1, 1)): "intersecting planes",
    ((2, 0), (2, 0)): "imaginary intersecting planes",
    ((1, 0), (2, 1)): "parabolic cylinder",
    ((1, 0), (1, 1)): "parallel planes",
    ((1, 0), (2, 0)): "imaginary parallel planes",
    ((1, 0), (1, 0)): "coincident planes",
}


@arguments_checked
@dataclass(frozen=True, eq=False)
class Plane:
    """The half-space behind a plane: f = (x - point) . normal, a distance.

    Parameters
    ----------
    point : (3,) array
        A point of the plane, metres.
    normal : (3,) array
        Its normal, out of the body, of any length.
    """

    point: Floats
    normal: Floats

    def __post_init__(self) -> None:
        length = float(np.linalg.norm(np.asarray(self.normal, float)))
        if not length > 0:
            raise SettingsError(
                message(
                    "implicit.plane-normal-zero",
                    "a plane needs a normal that is not zero, not {normal}",
                    normal=self.normal,
                )
            )
        object.__setattr__(self, "point", np.array(self.point, float))
        object.__setattr__(self, "normal", np.array(self.normal, float) / length)

    def value(self, xyz: Floats) -> Floats:
        """Return signed distances of (n, 3) points."""
        return np.asarray((points_of(xyz) - self.point) @ self.normal)

    def gradient(self, xyz: Floats) -> Floats:
        """Return the normal at each of (n, 3) points."""
        return np.tile(self.normal, (len(points_of(xyz)), 1))

    @property
    def bounds(self) -> Box:
        """The whole space."""
        return EVERYWHERE

    @property
    def lipschitz(self) -> float:
        """1: the field is a distance."""
        return 1.0


@arguments_checked
@dataclass(frozen=True, eq=False)
class Quadric:
    """f = X^T Q X.

    Parameters
    ----------
    matrix : (4, 4) array
        Q; only its symmetric part matters.
    region : pair of (3,) arrays
        Box in which the field is used, for its Lipschitz bound; by default that of an ellipsoid, else everything.
    """

    matrix: Floats
    region: Box | None = None

    def __post_init__(self) -> None:
        matrix = np.array(self.matrix, float)
        if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
            raise SettingsError(
                message(
                    "implicit.quadric-not-a-matrix",
                    "a quadric needs a finite 4x4 matrix, not {shape}",
                    shape=matrix.shape,
                )
            )
        matrix = (matrix + matrix.T) / 2
        matrix.flags.writeable = False
        object.__setattr__(self, "matrix", matrix)
        if self.region is not None:
            object.__setattr__(self, "region", box_of(*self.region))

    def value(self, xyz: Floats) -> Floats:
        """Return f at (n, 3) points."""
        a, b, c = self._parts
        xyz = points_of(xyz)
        return np.asarray(((xyz @ a + 2 * b) * xyz).sum(axis=1) + c)

    def gradient(self, xyz: Floats) -> Floats:
        """Return 2 (Q X) without its last component."""
        a, b, _ = self._parts
        return np.asarray(2 * (points_of(xyz) @ a + b))

    @property
    def bounds(self) -> Box:
        """Box of the ellipsoid, or the region given; infinite for the other types."""
        if self.kind != "ellipsoid":
            return self.region or EVERYWHERE
        centre, constant, _ = self._centre()
        half = np.sqrt(np.maximum(-constant * np.diag(np.linalg.inv(self._parts[0])), 0))
        return centre - half, centre + half

    @property
    def lipschitz(self) -> float:
        """Longest gradient in the region or the bounds: that of a corner, as the length is convex."""
        corners = np.array(np.meshgrid(*zip(*(self.region or self.bounds), strict=True))).reshape(3, -1).T
        if not np.isfinite(corners).all():
            return float(np.inf) if np.any(self._parts[0]) else float(2 * np.linalg.norm(self._parts[1]))
        return float(np.linalg.norm(self.gradient(corners), axis=1).max())

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Return bounds of f in boxes, by the gradient at their centres and the largest curvature."""
        lower, upper = box_corners(lower, upper)
        centre, half = (lower + upper) / 2, (upper - lower) / 2
        reach = (np.abs(self.gradient(centre)) * half).sum(axis=1)
        reach += np.abs(np.linalg.eigvalsh(self._parts[0])).max() * (half**2).sum(axis=1)
        value = self.value(centre)
        return value - reach, value + reach

    @property
    def kind(self) -> str:
        """One of the 17 types, such as "ellipsoid" or "hyperbolic paraboloid"."""
        eigenvalues = np.linalg.eigvalsh(self._parts[0])
        largest = np.abs(eigenvalues).max()
        if largest == 0:
            raise FitError(
                message("implicit.quadric-is-plane", "the quadric has no quadratic terms: it is a plane or empty")
            )
        p, n = int((eigenvalues > ZERO * largest).sum()), int((eigenvalues < -ZERO * largest).sum())
        _, constant, linear = self._centre()
        whole = (p + 1, n + 1) if linear else (p + int(constant > 0), n + int(constant < 0))
        if (n, whole[1]) > (p, whole[0]):
            p, n, whole = n, p, whole[::-1]
        return KINDS[(p, n), whole]

    @property
    def _parts(self) -> tuple[Floats, Floats, float]:
        return self.matrix[:3, :3], self.matrix[:3, 3], float(self.matrix[3, 3])

    def _centre(self) -> tuple[Floats, float, bool]:
        """Centre (that nearest to the origin if there are many), f there, and whether a linear term remains."""
        a, b, c = self._parts
        scale = np.abs(np.linalg.eigvalsh(a)).max()
        centre = -np.linalg.pinv(a, rcond=ZERO, hermitian=True) @ b
        rest = a @ centre + b
        size = float(np.abs(a) @ np.abs(centre) @ np.abs(centre) + 2 * np.abs(b) @ np.abs(centre) + abs(c))
        constant = float(centre @ a @ centre + 2 * b @ centre + c)
        linear = float(np.linalg.norm(rest)) > ZERO * (float(np.linalg.norm(b)) + scale * float(np.linalg.norm(centre)))
        return centre, 0.0 if abs(constant) <= ZERO * size else constant, linear


@arguments_checked
def quadric_from_coefficients(coefficients: ArrayLike, region: Box | None = None) -> Quadric:
    """Return the quadric Ax^2 + 2Bxy + 2Cxz + 2Dx + Ey^2 + 2Fyz + 2Gy + Hz^2 + 2Iz + J.

    Parameters
    ----------
    coefficients : (10,) array
        A to J.
    region : pair of (3,) arrays, optional
        Box in which the field is used.
    """
    a, b, c, d, e, f, g, h, i, j = np.asarray(coefficients, float)
    return Quadric(np.array([[a, b, c, d], [b, e, f, g], [c, f, h, i], [d, g, i, j]]), region)


@arguments_checked
def ellipsoid(centre: ArrayLike, semi_axes: ArrayLike, rotation: ArrayLike | None = None) -> Quadric:
    """Return an ellipsoid whose field has the slope 1 at the ends of its shortest axis.

    Parameters
    ----------
    centre : (3,) array
        Centre, metres.
    semi_axes : (3,) array
        Half lengths, metres.
    rotation : (3, 3) array, optional
        Columns are the directions of the axes; by default x, y and z.

    Raises
    ------
    SettingsError
        If a half length is not positive.
    """
    half, middle = np.asarray(semi_axes, float), np.asarray(centre, float)
    if half.shape != (3,) or not (half > 0).all():
        raise SettingsError(
            message(
                "implicit.ellipsoid-axes-not-positive",
                "an ellipsoid needs three positive half lengths, not {axes}",
                axes=half.tolist(),
            )
        )
    axes = np.eye(3) if rotation is None else np.asarray(rotation, float)
    a = (axes / half**2) @ axes.T
    b = -a @ middle
    c = middle @ a @ middle - 1
    return Quadric(np.block([[a, b[:, None]], [b[None], np.array([[c]])]]) * half.min() / 2)


@arguments_checked
def fit_quadric(xyz: ArrayLike) -> Quadric:
    """Return the quadric nearest to points, by Taubin's approximation f / |grad f| of the distance.

    Parameters
    ----------
    xyz : (n, 3) array
        Points, metres; at least 9.

    Returns
    -------
    Quadric
        Scaled to a mean squared gradient of 1 at the points; negative at their centroid.

    Raises
    ------
    FitError
        If there are fewer than 9 points, or if they lie on more than one quadric.

    Notes
    -----
    G. Taubin, Estimation of planar curves, surfaces, and nonplanar space curves defined by implicit equations, IEEE
    PAMI 13(11), 1991: the smallest eigenvalue of M c = lambda N c, where M holds the mean products of the monomials and
    N those of their gradients.
    """
    from scipy.linalg import eigh

    points = points_of(xyz)
    if len(points) < 9:
        raise FitError(
            message(
                "implicit.too-few-points-for-quadric",
                "{count} points do not fix a quadric: give 9 or more",
                count=len(points),
            )
        )
    middle = points.mean(axis=0)
    scale = float(np.sqrt(((points - middle) ** 2).mean())) or 1.0
    x, y, z = ((points - middle) / scale).T
    one, nil = np.ones_like(x), np.zeros_like(x)
    terms = np.stack([x * x, 2 * x * y, 2 * x * z, 2 * x, y * y, 2 * y * z, 2 * y, z * z, 2 * z], axis=1)
    slopes = 2 * np.stack(
        [
            np.stack([x, y, z, one, nil, nil, nil, nil, nil], axis=1),
            np.stack([nil, x, nil, nil, y, z, one, nil, nil], axis=1),
            np.stack([nil, nil, x, nil, nil, y, nil, z, one], axis=1),
        ]
    )
    # The constant has no gradient: it is minus the mean of the other terms.
    mean = terms.mean(axis=0)
    m = (terms - mean).T @ (terms - mean) / len(x)
    n = np.einsum("kni,knj->ij", slopes, slopes) / len(x)
    if np.linalg.matrix_rank(n, tol=1e-10 * np.linalg.norm(n)) < len(n):
        raise FitError(
            message(
                "implicit.quadric-ambiguous",
                "the points lie on more than one quadric: add points off their plane or curve",
            )
        )
    eigenvalues, vectors = eigh(m, n)
    if eigenvalues[1] < 1e-12:
        raise FitError(
            message(
                "implicit.quadric-ambiguous",
                "the points lie on more than one quadric: add points off their plane or curve",
            )
        )
    c = vectors[:, 0]
    unit = quadric_from_coefficients([*c, -mean @ c]).matrix * scale
    back = np.eye(4)
    back[:3, :3] /= scale
    back[:3, 3] = -middle / scale
    matrix = back.T @ unit @ back
    inside = np.append(middle, 1.0)
    return Quadric(-matrix if inside @ matrix @ inside > 0 else matrix)
