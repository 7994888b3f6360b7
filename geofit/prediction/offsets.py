"""Sources that lie above or below the others as a whole: a datum, a velocity, a depth counted from another mouth.

Points of two kinds scatter about one horizon. Where those of one kind lie off by a constant, the surface runs from the
ones to the others, and its errors look like noise. The constant is found as one more unknown for each kind, beside the
field and the plane: with Q = W (I - C W), C the field's posterior covariance at the points, it is (X' Q X)^-1 X' Q z
for the indicators X of the kinds, of the covariance noise^2 (X' Q X)^-1 (generalized least squares; N. Cressie,
Statistics for Spatial Data, 1993, sec. 3.4.5).
"""

from __future__ import annotations

import numpy as np

from geofit.data.labels import Labels
from geofit.data.prediction import SourceOffset
from geofit.fitting.calibration import Calibration
from geofit.fitting.conflicts import trust_of
from geofit.fitting.model import Model
from geofit.fitting.posterior import Posterior

__all__ = ["source_offsets"]

#: Fewest points of a kind that is compared, and how many standard deviations make an offset.
FEWEST, SURE = 10, 4.0


def source_offsets(model: Model, given: Posterior, calibration: Calibration) -> tuple[SourceOffset, ...]:
    """Return the kinds of points that lie off those measured nearest to the rock, the surest first.

    Parameters
    ----------
    model : Model
        A fitted height field; offsets within its interior tolerance do not count.
    given : Posterior
        Its field.
    calibration : Calibration
        By how much left-out errors widen the field's standard deviation: the offsets' is widened alike.
    """
    kinds = model.problem.points.labels["kind"][given.kept]
    counts = np.bincount(kinds.codes, minlength=len(kinds.table))
    trust = trust_of(Labels(np.arange(len(kinds.table), dtype=np.int32), kinds.table))
    compared = [code for code in np.argsort(trust, kind="stable") if counts[code] >= FEWEST]
    if len(compared) < 2:
        return ()
    of_kind = (kinds.codes[:, None] == np.array(compared[1:])).astype(float)
    weighed = given.weight[:, None] * of_kind
    matrix = given.matrix(given.plane)
    over = matrix @ given.drift
    smoothed = matrix @ given.factor.solve(matrix.T @ weighed) + over @ np.linalg.solve(given.moment, over.T @ weighed)
    normal = weighed.T @ (of_kind - smoothed)
    inverse = np.linalg.pinv((normal + normal.T) / 2, hermitian=True)
    offset = inverse @ (weighed.T @ given.residual)
    sd = given.noise * max(calibration.common, 1.0) * np.sqrt(np.maximum(np.diag(inverse), 0.0))
    found = [
        SourceOffset(kinds.table[code], kinds.table[compared[0]], int(counts[code]), float(size), float(deviation))
        for code, size, deviation in zip(compared[1:], offset, sd, strict=True)
        if abs(size) > max(SURE * deviation, model.problem.settings.interior_tolerance)
    ]
    return tuple(sorted(found, key=lambda one: -abs(one.offset) / max(one.sd, 1e-300)))
