"""Patches proven not to cross: height fields over one plane, side by side."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from geofit.geometry.one_sheet import one_sheet
from tests.surfaces import fold, height_field, split


def turned(patches, seed):
    """The patches in another attitude and place."""
    rotation = Rotation.random(rng=seed).as_matrix()
    return [replace(patch, control=patch.control @ rotation.T + np.array([300.0, -200.0, 90.0])) for patch in patches]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("slope", [None, lambda x, y: 0.3 * x - 0.1 * y, lambda x, y: 1e-7 * x**2 / 1000])
def test_parts_of_a_height_field_are_one_sheet_in_any_attitude(seed, slope):
    parts = split(height_field(z=slope), [300.0, 700.0], [200.0])
    assert one_sheet(parts)
    assert one_sheet(turned(parts, seed))


def test_what_folds_or_crosses_is_none():
    assert not one_sheet([fold()])
    up, down = height_field(z=lambda x, y: 0.1 * x - 50), height_field(z=lambda x, y: 50 - 0.1 * x)
    assert not one_sheet([up, down])


@pytest.mark.parametrize("shift", [-20.0, -1e-3])
def test_patches_that_overlap_are_none(shift):
    first, second = split(height_field(), [500.0], [])
    assert one_sheet([first, second])
    assert not one_sheet([first, replace(second, control=second.control + np.array([shift, 0.0, 0.0]))])


def test_a_patch_laid_out_in_another_direction_is_none():
    first, second = split(height_field(z=lambda x, y: np.zeros_like(x)), [500.0], [])
    assert not one_sheet([first, replace(second, control=second.control @ Rotation.from_euler("z", 0.2).as_matrix())])


def test_control_points_pushed_past_each_other_are_none():
    patch = height_field()
    control = patch.control.copy()
    control[10, 8, 0] += 120.0
    assert not one_sheet([replace(patch, control=control)])


def test_unequal_weights_are_none():
    patch = height_field()
    weights = np.ones(patch.control.shape[:2])
    assert one_sheet([replace(patch, weights=weights)])
    weights[3, 4] = 2.0
    assert not one_sheet([replace(patch, weights=weights)])
