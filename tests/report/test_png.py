"""PNG of drawn pictures, as another program reads it."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from geofit.report.png import png_of


@pytest.mark.parametrize("shape", [(1, 1), (7, 13), (300, 201)])
def test_pillow_reads_the_pixels_that_were_written(shape):
    pixels = np.random.default_rng(0).integers(0, 256, (*shape, 3), np.uint8)
    # As a canvas hands them over: every fourth byte left out.
    four = np.dstack([pixels, np.full(shape, 255, np.uint8)])
    with Image.open(io.BytesIO(png_of(four[..., :3]))) as read:
        assert read.mode == "RGB"
        np.testing.assert_array_equal(np.asarray(read), pixels)
