from __future__ import annotations

import numpy as np
import pytest
from surfaces import fold, height_field, nine, wave

from geofit.geometry import foot_points
from geofit.geometry import projection as distance
from geofit.geometry.foot_points import foot_points_over_plan


def beside(patch, n, spread, seed=0):
    """Places on a patch moved along its normals."""
    rng = np.random.default_rng(seed)
    u0, u1, v0, v1 = patch.domain
    u, v = rng.uniform(u0, u1, n), rng.uniform(v0, v1, n)
    return patch.evaluate(u, v) + patch.normal(u, v) * rng.normal(0, spread, n)[:, None]


@pytest.mark.parametrize("turn", [0.0, 0.7])
@pytest.mark.parametrize("spread", [1e-6, 0.3, 5.0])
def test_proven_feet_are_those_of_the_search(spread, turn):
    patch = height_field(turn=turn)
    xyz = beside(patch, 3000, spread)
    found, searched = foot_points_over_plan([patch], xyz), distance.foot_points_by_search([patch], xyz)
    sure = found.converged
    assert sure.mean() > 0.9
    np.testing.assert_allclose(found.distance[sure], searched.distance[sure], atol=1e-10)
    np.testing.assert_allclose(found.foot[sure], searched.foot[sure], atol=1e-7)
    np.testing.assert_allclose(patch.evaluate(found.u[sure], found.v[sure]), found.foot[sure], atol=1e-9)


def test_every_patch_of_a_surface_has_its_own_feet():
    _, patches = nine()
    xyz = np.concatenate([beside(patch, 200, 0.1, seed) for seed, patch in enumerate(patches)])
    found, searched = foot_points_over_plan(patches, xyz), distance.foot_points_by_search(patches, xyz)
    sure = found.converged
    assert sure.mean() > 0.9
    assert np.unique(found.patch[sure]).tolist() == list(range(len(patches)))
    np.testing.assert_array_equal(found.patch[sure], searched.patch[sure])
    np.testing.assert_allclose(found.distance[sure], searched.distance[sure], atol=1e-10)


@pytest.mark.parametrize("spread", [1e-6, 0.3, 5.0, 80.0])
def test_compiled_walks_prove_what_arrays_prove(monkeypatch, spread):
    _, seamed = nine()
    for patches in (seamed, [height_field(turn=0.7)], [height_field(nu=24, nv=18)]):
        rng, xyz = np.random.default_rng(5), np.concatenate([beside(patch, 400, spread) for patch in patches])
        # Some beyond the surface, some exactly on its rim and seams.
        xyz = np.concatenate([xyz, xyz[:50] + rng.normal(0, 400, (50, 3))])
        xyz = np.concatenate([xyz, *(patch.control.reshape(-1, 3)[[0, -1]] for patch in patches)])
        by_arrays = foot_points_over_plan(patches, xyz)
        monkeypatch.setattr(foot_points, "COMPILED", 1)
        compiled = foot_points_over_plan(patches, xyz)
        monkeypatch.undo()
        np.testing.assert_array_equal(compiled.converged, by_arrays.converged)
        np.testing.assert_array_equal(compiled.patch, by_arrays.patch)
        for name in ("distance", "foot", "u", "v"):
            np.testing.assert_allclose(getattr(compiled, name), getattr(by_arrays, name), atol=1e-9, err_msg=name)


def test_what_may_have_another_foot_is_left_to_the_search():
    patch = height_field()
    far, rim, off = [500.0, 300.0, 300.0], [0.01, 300.0, 3.0], [-5.0, 300.0, 0.0]
    assert not foot_points_over_plan([patch], np.array([far, rim, off])).converged.any()


def test_creases_folds_and_patches_over_each_other_prove_nothing():
    xyz = beside(height_field(), 50, 0.01)
    creased = height_field(nu=24, nv=18, multiplicity=3)
    above = height_field(z=lambda x, y: 1 + wave(x, y))
    for patches in ([creased], [fold()], [height_field(), above], [height_field(), height_field(turn=0.3)]):
        assert not foot_points_over_plan(patches, xyz).converged.any()


def test_points_on_a_seam_or_a_rim_need_no_search():
    _, patches = nine()
    u0, u1, v0, v1 = patches[0].domain
    v = np.linspace(v0, v1, 9)
    for edge in (u0, u1):
        on = patches[0].evaluate(np.full(9, edge), v)
        found = foot_points_over_plan(patches, on)
        assert found.converged.all()
        np.testing.assert_allclose(found.distance, 0, atol=1e-9)
        np.testing.assert_allclose(found.foot, on, atol=1e-9)
