"""Colours of the pictures: told apart by every eye, on white paper and in a dark window."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from geofit.data.settings import FitSettings
from geofit.report.style import HORIZONS, bands, horizon_colours

#: Light of red, green and blue as it reaches eyes without one kind of cones (Machado, Oliveira and Fernandes 2009).
EYES = {
    "all colours": np.eye(3),
    "no red": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "no green": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
}
XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
WHITE, DARK = "#ffffff", "#1b2026"
#: Colours nearer than this in CIELAB are one colour in a small mark.
APART = 20.0


def light(colour):
    """Return the linear light of #rrggbb."""
    c = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def lab(colour, eye):
    xyz = XYZ @ np.clip(eye @ light(colour), 0, 1) / [0.95047, 1.0, 1.08883]
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def contrast(one, other):
    a, b = sorted(float(XYZ[1] @ light(colour)) for colour in (one, other))
    return (b + 0.05) / (a + 0.05)


def nearest(colours, eye):
    return min(float(np.linalg.norm(lab(a, eye) - lab(b, eye))) for a, b in combinations(colours, 2))


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("dark", [False, True])
def test_every_band_is_told_from_every_other(dark, eye):
    made = bands(FitSettings(), dark=dark)
    colours = [made[0].below, *(band.below for band in made[1:]), *(band.above for band in made[1:])]
    assert len(set(colours)) == 7
    assert nearest(colours, EYES[eye]) > APART


@pytest.mark.parametrize("dark", [False, True])
def test_what_is_farther_off_stands_out_more(dark):
    made = bands(FitSettings(), dark=dark)[1:]
    for side in ([band.below for band in made], [band.above for band in made]):
        seen = [contrast(colour, DARK if dark else WHITE) for colour in side]
        assert seen == sorted(seen)
        assert seen[-1] > 2 * seen[0]


def test_bands_have_the_bounds_of_the_tolerances_in_both_themes():
    settings = FitSettings()
    light_bands, dark_bands = bands(settings), bands(settings, dark=True)
    bounds = sorted({settings.boundary_tolerance, settings.interior_tolerance, settings.epsilon})
    assert [band.low for band in light_bands] == [0.0, *bounds]
    assert [(b.low, b.high, b.label, b.area) for b in light_bands] == [
        (b.low, b.high, b.label, b.area) for b in dark_bands
    ]


@pytest.mark.parametrize("colour", HORIZONS)
def test_a_horizon_stands_out_from_paper_and_from_a_dark_window(colour):
    assert contrast(colour, WHITE) > 2.9
    assert contrast(colour, DARK) > 2.7


@pytest.mark.parametrize("eye", EYES)
def test_the_first_horizons_are_told_apart(eye):
    # Every horizon has its name beside its colour: less is enough.
    assert nearest(HORIZONS[:5], EYES[eye]) > 12.0


def test_a_horizon_has_the_colour_of_its_place():
    assert horizon_colours(["a", "b", "a", "c"]) == dict(zip("abc", HORIZONS, strict=False))
    many = horizon_colours(str(k) for k in range(20))
    assert many["9"] == HORIZONS[9 % len(HORIZONS)]
