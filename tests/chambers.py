"""A rock volume that a person can check by hand."""

from __future__ import annotations

import numpy as np


def chambers():
    """Two chambers of 7 voxels and a channel of one, open at both ends of axis 2, and a closed chamber; 1 is rock."""
    grains = np.ones((21, 9, 20), np.uint8)
    grains[1:8, 1:8, :7] = grains[1:8, 1:8, 13:] = grains[4, 4] = 0
    grains[12:17, 2:7, 5:11] = 0
    return grains
