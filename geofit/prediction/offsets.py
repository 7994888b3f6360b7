"""Systematic offsets between sources, caused by a wrong datum, velocity or depth reference.

The points of all kinds sample one horizon. If those of one kind are offset by a constant, the surface passes between
the kinds, and the offset is mistaken for noise. The offset of each kind is estimated as an additional unknown, together
with the field and the plane. With Q = W (I - C W), C the field's posterior covariance at the points and X the
indicators of the kinds, the offsets are (X' Q X)^-1 X' Q z, with covariance noise^2 (X' Q X)^-1 (generalized least
squares; N. Cressie, Statistics for Spatial Data, 1993, sec. 3.4.5). A single wrong elevation would drag the kinds
around it: each outlier has an unknown of its own, which leaves it out.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from geofit.data.labels import Labels
from geofit.data.prediction import Outlier, SourceOffset
from geofit.fitting.calibration import Calibration
from geofit.fitting.conflicts import trust_of_kinds
from geofit.fitting.model import Model
from geofit.fitting.outliers import MOST
from geofit.fitting.posterior import Posterior

__all__ = ["source_offsets"]

Ints = NDArray[np.int64]

#: Minimum number of points of a kind, and the number of standard deviations from which an offset is significant.
FEWEST, SURE = 10, 4.0


def source_offsets(
    model: Model, given: Posterior, calibration: Calibration, outliers: Sequence[Outlier]
) -> tuple[SourceOffset, ...]:
    """Return the significant offsets from the kind measured nearest to the rock, the most significant first.

    Parameters
    ----------
    model : Model
        A fitted height field; offsets within its interior tolerance are ignored.
    given : Posterior
        Its field.
    calibration : Calibration
        The factor by which left-out errors widen the field's standard deviation; it widens the offsets' as well.
    outliers : sequence of Outlier
        Points that their neighbours contradict.
    """
    kinds = model.problem.points.labels["kind"][given.kept]
    counts = np.bincount(kinds.codes, minlength=len(kinds.table))
    compared = [code for code in np.argsort(trust_of_kinds(kinds), kind="stable") if counts[code] >= FEWEST]
    if len(compared) < 2:
        return ()
    others = compared[1:]
    of_kind = kinds.codes[:, None] == np.array(others)
    wrong = np.arange(len(kinds))[:, None] == _single(kinds, given.kept, outliers)
    unknown = np.hstack([of_kind, wrong]).astype(float)
    weighed = given.weight[:, None] * unknown
    matrix = given.matrix(given.plane)
    over = matrix @ given.drift
    smoothed = matrix @ given.factor.solve(matrix.T @ weighed) + over @ np.linalg.solve(given.moment, over.T @ weighed)
    normal = weighed.T @ (unknown - smoothed)
    inverse = np.linalg.pinv((normal + normal.T) / 2, hermitian=True)
    offset = inverse @ (weighed.T @ given.residual)
    sd = given.noise * max(calibration.common, 1.0) * np.sqrt(np.maximum(np.diag(inverse), 0.0))
    vertical = model.problem.parametrization.frame.kind == "map"
    reference = kinds.table[compared[0]]
    found = [
        SourceOffset(kinds.table[code], reference, int(counts[code]), float(size), float(deviation), vertical)
        for code, size, deviation in zip(others, offset[: len(others)], sd[: len(others)], strict=True)
        if abs(size) > max(SURE * deviation, model.problem.settings.interior_tolerance)
    ]
    return tuple(sorted(found, key=lambda one: -abs(one.offset) / max(one.sd, 1e-300)))


def _single(kinds: Labels, kept: Ints, outliers: Sequence[Outlier]) -> Ints:
    """Return the rows of the outliers that are wrong one by one: many of a kind show that the kind is offset."""
    rows = np.flatnonzero(np.isin(kept, [one.index for one in outliers]))
    size = len(kinds.table)
    counts, wrong = np.bincount(kinds.codes, minlength=size), np.bincount(kinds.codes[rows], minlength=size)
    single = (wrong <= MOST * counts) | (counts < FEWEST)
    return np.asarray(rows[single[kinds.codes[rows]]])
