"""Left-out sections by ITK's morphological contour interpolation (package itk-morphologicalcontourinterpolation)."""

from __future__ import annotations

import numpy as np
from bodies.sectioned import BODIES, LINE, overlap, plane_of, planes_across

__all__ = ["morphological"]


def morphological(name: str, count: int) -> float | None:
    """Return the mean intersection over union with the middle planes left out in turn; None without the package."""
    try:
        import itk
    except ImportError:
        return None
    truth, axis = BODIES[name]
    at = planes_across(truth, axis, count)
    # Slices as far apart as the raster's nodes on them.
    step = LINE[1] - LINE[0]
    index = np.round((at - at[0]) / step).astype(int) + 1
    scores = []
    for left in (count // 2 - 1, count // 2, count // 2 + 1):
        labels = np.zeros((index[-1] + 2, len(LINE), len(LINE)), np.uint8)
        for k, place in enumerate(at.tolist()):
            if k != left:
                labels[index[k]] = plane_of(truth, axis, place)[1]
        found = itk.morphological_contour_interpolator(itk.image_from_array(labels), axis=2)
        got = itk.array_from_image(found)[index[left]] > 0
        scores.append(overlap(plane_of(truth, axis, float(at[left]))[1], got))
    return float(np.mean(scores))
