"""What moved between two states of a horizon, and the honest test of the earlier band."""

from __future__ import annotations

import numpy as np
import pytest
from truth import EASTING, NORTHING, hills

import geofit
from geofit.data.errors import SettingsError
from geofit.fitting.pipeline import fit_horizon
from geofit.prediction.examine import examine
from geofit.site.change import horizon_change
from geofit.site.new_contacts import blind_test, new_points

SIZE = 1000.0


def holes(height, n, seed, noise=0.05, prefix="ZK"):
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(0, SIZE, (2, n)) + np.array([[EASTING], [NORTHING]])
    z = height(x, y) + rng.normal(0, noise, n)
    return geofit.PointSet(
        np.column_stack([x, y, z]), "borehole", [f"{prefix}{k}" for k in range(n)], row=np.arange(n) + 2, file="h.csv"
    )


def grid(height, step=50.0):
    x, y = (a.ravel() for a in np.meshgrid(np.arange(0, SIZE + 1, step), np.arange(0, SIZE + 1, step)))
    x, y = x + EASTING, y + NORTHING
    return geofit.PointSet(np.column_stack([x, y, height(x, y)]))


def bump(x, y, radius=300.0, top=2.0):
    r = np.hypot(x - EASTING - 500, y - NORTHING - 500) / radius
    return np.where(r < 1, top * (1 - np.minimum(r, 1) ** 2) ** 3, 0.0)


def test_the_area_that_moved_is_that_of_the_bump():
    base = hills(3, SIZE, shortest=400, relief=10)
    before = fit_horizon(grid(base))
    after = fit_horizon(grid(lambda x, y: base(x, y) + bump(x, y)))
    found = horizon_change(before, after, epsilon=0.5)
    # 2 (1 - r^2)^3 > 0.5 within r^2 < 1 - 0.25^(1/3) of the radius.
    true = np.pi * 300**2 * (1 - 0.25 ** (1 / 3))
    assert found.moved == pytest.approx(true, rel=0.03)
    assert found.most == pytest.approx(2.0, abs=0.05)
    assert abs(found.least) < 0.1
    assert np.hypot(found.place[0] - EASTING - 500, found.place[1] - NORTHING - 500) < 25
    # Its volume is pi R^2 top / 4.
    assert found.mean * found.area == pytest.approx(np.pi * 300**2 * 2.0 / 4, rel=0.03)
    assert len(found.areas) == 1
    assert found.areas[0].area == pytest.approx(found.moved)
    assert found.area == pytest.approx(SIZE**2, rel=0.02)
    assert found.share == pytest.approx(found.moved / found.area)
    assert found.text.code == "site.surface-moved"


def test_a_state_against_itself_has_not_moved():
    surface = fit_horizon(grid(hills(4, SIZE, shortest=400)))
    found = horizon_change(surface, surface)
    assert found.moved == 0
    assert found.areas == ()
    assert found.rms == 0
    assert found.only_before == found.only_after == 0


def test_two_bumps_are_two_areas_and_new_ground_is_counted_apart():
    base = hills(5, SIZE, shortest=500, relief=8)

    def shifted(x, y):
        return base(x, y) + bump(x + 250, y + 250, 150, 3.0) - bump(x - 250, y - 250, 200, 3.0)

    west = grid(base)
    west = west[west.xyz[:, 0] <= EASTING + 900]
    found = horizon_change(fit_horizon(west), fit_horizon(grid(shifted)), epsilon=0.5)
    first, second = found.areas[:2]
    assert first.most < -2 < 2 < second.most
    assert first.area > second.area
    assert found.only_after == pytest.approx(100 * SIZE, rel=0.1)
    assert found.only_before < 0.01 * SIZE**2


def test_what_counts_as_moved_is_above_zero():
    surface = fit_horizon(grid(hills(4, SIZE, shortest=400)))
    with pytest.raises(SettingsError):
        horizon_change(surface, surface, epsilon=0.0)


def test_a_corrected_hole_is_not_new_and_a_pick_at_a_known_place_neither():
    old = geofit.PointSet.concatenate(
        [holes(hills(1), 5, 1), geofit.PointSet([[EASTING, NORTHING, 5.0]], section=["C1"])]
    )
    corrected = old.xyz.copy()
    corrected[2, 2] += 3.0
    more = geofit.PointSet([[EASTING, NORTHING, 5.0], [EASTING, NORTHING, 6.0]], section=["C2", "C1"])
    new = geofit.PointSet.concatenate([old.with_(xyz=corrected), more, holes(hills(1), 2, 7, prefix="N")])
    assert new_points(old, new).tolist() == [6, 7, 8, 9]


def test_residual_and_band_are_those_of_the_earlier_state():
    height = hills(11, SIZE, shortest=300, relief=12)
    known, more = holes(height, 70, 1), holes(height, 12, 2, prefix="N")
    far = geofit.PointSet([[EASTING + 9e3, NORTHING, 1500.0]], "borehole", ["FAR"])
    later = geofit.PointSet.concatenate([known, more, far])
    before = fit_horizon(known)
    found = examine(before)
    test = blind_test(before, found.uncertainty, known, later)
    assert [one.group for one in test.contacts] == [*more.hole.tolist(), "FAR"]
    beyond = test.contacts[-1]
    assert beyond.inside is None
    assert np.isnan(beyond.residual)
    for one in test.judged:
        predicted = float(before.elevation(one.x, one.y))
        assert one.predicted == predicted
        assert one.residual == pytest.approx(one.z - predicted)
        sd = geofit.prediction.bands.prediction_sd(before, found.uncertainty, [[one.x, one.y]], "contact")[0]
        assert one.high - one.low == pytest.approx(2 * 1.6449 * sd, rel=1e-4)
        assert one.inside == (one.low <= one.z <= one.high)
    assert test.share == sum(one.inside for one in test.judged) / len(test.judged)
    assert blind_test(before, None, known, later).judged == ()


def test_over_many_states_nine_new_contacts_in_ten_lie_inside():
    inside = judged = 0
    for seed in range(8):
        height = hills(seed, SIZE, shortest=(150, 300, 600)[seed % 3], relief=(5, 20)[seed % 2])
        known, more = holes(height, 60, 100 + seed, 0.1), holes(height, 40, 200 + seed, 0.1, "N")
        before = fit_horizon(known)
        later = geofit.PointSet.concatenate([known, more])
        test = blind_test(before, examine(before).uncertainty, known, later)
        inside, judged = inside + test.inside, judged + len(test.judged)
    assert judged > 200
    assert 0.8 < inside / judged <= 0.97


def test_a_band_that_was_too_narrow_is_called_so():
    height = hills(21, SIZE, shortest=300, relief=12)
    known, more = holes(height, 60, 1), holes(height, 30, 2, prefix="N")
    before = fit_horizon(known)
    moved = more.with_(xyz=more.xyz + np.array([0, 0, 40.0]))
    test = blind_test(before, examine(before).uncertainty, known, geofit.PointSet.concatenate([known, moved]))
    assert test.too_narrow
    assert test.text.code == "site.new-contacts-outside-band"
    assert test.probability < 1e-6
