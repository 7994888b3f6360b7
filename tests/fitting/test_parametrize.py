from __future__ import annotations

import numpy as np
import pytest
from refusals import refused, with_code
from truth import EASTING, NORTHING, fold_at, folded, hills, paper_arrangement, rms

from geofit import FitSettings, PointSet, fit_horizon
from geofit.data.errors import FitError
from geofit.fitting.parametrize import parametrize, turns_over
from geofit.geometry.frame import best_plane_frame

SETTINGS = FitSettings()


def fault(dip, azimuth=110.0, n=150, roughness=1.5, seed=0):
    """A gently waved plane of the given dip; true distance from the plane up to ``roughness``."""
    a, d = np.radians(azimuth), np.radians(dip)
    down = np.array([np.sin(a) * np.cos(d), np.cos(a) * np.cos(d), -np.sin(d)])
    strike = np.array([np.cos(a), -np.sin(a), 0.0])
    s, t = np.random.default_rng(seed).uniform(-250, 250, (2, n))
    off = roughness * np.sin(s / 90) * np.cos(t / 110)
    xyz = s[:, None] * strike + t[:, None] * down + off[:, None] * np.cross(strike, down)
    return PointSet(xyz + np.array((EASTING, NORTHING, 700)))


def level(n=80, slope=0.1):
    rng = np.random.default_rng(1)
    plan = rng.uniform(0, 900, (n, 2)) + np.array((EASTING, NORTHING))
    return PointSet(np.column_stack([plan, hills(1)(*plan.T) + slope * (plan[:, 0] - EASTING)]))


@pytest.mark.parametrize(
    ("points", "kind"),
    [
        (level(), "map"),
        (paper_arrangement(0).points, "map"),
        (fault(30), "map"),
        (fault(50), "map"),
        (fault(72), "best-plane"),
        (fault(85, azimuth=10), "best-plane"),
        (folded(), "sections"),
        (folded(reverse=(1, 4)), "sections"),
        (folded(azimuth=0.7), "sections"),
    ],
    ids=["gentle", "paper", "30", "50", "72", "85", "fold", "fold drawn both ways", "turned fold"],
)
def test_the_frame_follows_the_surface(points, kind):
    parametrization = parametrize(points, SETTINGS, None)
    assert parametrization.frame.kind == kind
    assert parametrization.parametric == (kind == "sections")
    assert parametrization.notes[0]


def test_a_vertical_fault_seen_by_scattered_points_is_no_height_field():
    parametrization = parametrize(fault(90, n=80), SETTINGS, None)
    assert parametrization.frame.kind == "best-plane"


@pytest.mark.parametrize(("count", "aside"), [(8, 3.0), (25, 0.0)])
def test_rough_rock_in_a_row_of_holes_is_no_upright_plane(count, aside):
    rng = np.random.default_rng(0)
    along, across = 30.0 * np.arange(count), rng.normal(0, aside, count)
    plan = np.outer(along, (0.8, 0.6)) + np.outer(across, (-0.6, 0.8)) + (EASTING, NORTHING)
    points = PointSet(np.column_stack([plan, 500 + rng.normal(0, 6, count)]), kind="borehole")
    parametrization = parametrize(points, SETTINGS, None)
    assert parametrization.frame.kind == "map"
    assert np.isfinite(fit_horizon(points).elevation(*points.xyz[:, :2].T)).all()


@pytest.mark.parametrize(("dip", "high"), [(85, 120), (90, 300)])
def test_a_long_upright_fault_is_no_height_field_over_the_map(dip, high):
    rng, d = np.random.default_rng(5), np.radians(dip)
    s, t, off = rng.uniform(0, 2000, 150), rng.uniform(0, high, 150), rng.normal(0, 0.5, 150)
    down = np.array([np.cos(d), 0.0, -np.sin(d)])
    xyz = s[:, None] * (0, 1, 0) + t[:, None] * down + off[:, None] * np.cross(down, (0, 1, 0))
    parametrization = parametrize(PointSet(xyz + np.array((EASTING, NORTHING, 700))), SETTINGS, None)
    assert parametrization.frame.kind == "best-plane"


def test_one_section_is_a_height_field_over_the_map():
    t = np.linspace(0, 800, 40)
    points = PointSet(
        np.column_stack([EASTING + 0.6 * t, NORTHING + 0.8 * t, 500 + 20 * np.sin(t / 90)]),
        section="S1",
        kind="section",
    )
    parametrization = parametrize(points, SETTINGS, None)
    assert parametrization.frame.kind == "map"
    # v runs along the line, and the area is a strip around it.
    np.testing.assert_allclose(np.abs(parametrization.frame.axes[1, :2]), [0.6, 0.8], atol=1e-6)
    u0, u1, v0, v1 = parametrization.area
    assert v1 - v0 == pytest.approx(800)
    assert 0 < u1 - u0 < 200


@pytest.mark.parametrize("azimuth", [0, 33, 90])
def test_collinear_points_get_a_strip_to_stand_on(azimuth):
    a, t = np.radians(azimuth), np.linspace(0, 500, 12)
    points = PointSet(np.column_stack([EASTING + t * np.cos(a), NORTHING + t * np.sin(a), 300 + 0.1 * t]))
    parametrization = parametrize(points, SETTINGS, None)
    assert parametrization.frame.kind == "map"
    u0, u1, v0, v1 = parametrization.area
    assert u1 > u0
    assert v1 > v0
    assert min(u1 - u0, v1 - v0) >= 0.05 * 400


@pytest.mark.parametrize("kind", ["map", "best-plane"])
def test_a_frame_is_taken_as_asked(kind):
    for points in (level(), fault(72)):
        assert parametrize(points, FitSettings(frame=kind), None).frame.kind == kind


def test_sections_without_sections_are_a_fit_error():
    with refused(FitError, "fitting.frame-needs-sections", lines=0):
        parametrize(level(), FitSettings(frame="sections"), None)
    with refused(FitError, "fitting.frame-needs-sections", lines=1):
        parametrize(folded(lines=1), FitSettings(frame="sections"), None)


def test_places_and_values_give_the_points_back():
    for points in (level(), fault(72), folded()):
        parametrization = parametrize(points, SETTINGS, None)
        local = (
            parametrization.values
            if parametrization.parametric
            else np.column_stack([parametrization.plane, parametrization.values])
        )
        np.testing.assert_allclose(
            parametrization.frame.turn_back(local) + parametrization.frame.origin, points.xyz, atol=1e-8
        )
        u0, u1, v0, v1 = parametrization.area
        assert (parametrization.plane >= (u0 - 1e-9, v0 - 1e-9)).all()
        assert (parametrization.plane <= (u1 + 1e-9, v1 + 1e-9)).all()


def test_the_study_area_widens_the_rectangle_and_points_beyond_it_are_told():
    points = level()
    low, high = points.xyz[:, :2].min(axis=0), points.xyz[:, :2].max(axis=0)
    wide = np.array([low - 100, [high[0] + 100, low[1] - 100], high + 100, [low[0] - 100, high[1] + 100]])
    assert parametrize(points, SETTINGS, wide).area[1] - parametrize(points, SETTINGS, wide).area[0] == pytest.approx(
        high[0] - low[0] + 200
    )
    small = np.array([low + 200, [high[0] - 200, low[1] + 200], high - 200, [low[0] + 200, high[1] - 200]])
    parametrization = parametrize(points, SETTINGS, small)
    assert with_code(parametrization.notes, "fitting.points-beyond-study-area").params["count"] > 0
    assert (parametrization.plane >= (parametrization.area[0], parametrization.area[2])).all()


def test_without_sections_v_follows_a_turned_study_area():
    a = np.radians(30)
    turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    corners = np.array([[0, 0], [900, 0], [900, 300], [0, 300.0]]) @ turn.T + (EASTING, NORTHING)
    plan = np.random.default_rng(0).uniform(0, (900, 300), (90, 2)) @ turn.T + (EASTING, NORTHING)
    parametrization = parametrize(PointSet(np.column_stack([plan, np.full(90, 300.0)])), SETTINGS, corners)
    sides = sorted(
        (parametrization.area[1] - parametrization.area[0], parametrization.area[3] - parametrization.area[2])
    )
    np.testing.assert_allclose(sides, [300, 900], atol=1)


def valley(azimuth, n=60, length=1800.0, width=250.0, seed=3):
    """Places of holes along a valley that runs at an angle from east, degrees."""
    a = np.radians(azimuth)
    turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    return np.random.default_rng(seed).uniform(-0.5, 0.5, (n, 2)) * (length, width) @ turn.T


@pytest.mark.parametrize("azimuth", [20, 45, 110, 160])
def test_without_sections_or_a_study_area_v_follows_holes_along_a_valley(azimuth):
    plan = valley(azimuth) + np.array((EASTING, NORTHING))
    points = PointSet(np.column_stack([plan, hills(1)(*plan.T)]))
    parametrization = parametrize(points, SETTINGS, None)
    u0, u1, v0, v1 = parametrization.area
    assert (u1 - u0) * (v1 - v0) < 1.1 * 1800 * 250
    np.testing.assert_allclose(
        parametrization.frame.turn_back(np.column_stack([parametrization.plane, parametrization.values]))
        + parametrization.frame.origin,
        points.xyz,
        atol=1e-9,
    )


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("n", [4, 9, 30, 200])
def test_chance_does_not_turn_the_axes(n, seed):
    plan = np.random.default_rng(seed).uniform(0, (900, 600), (n, 2)) + np.array((EASTING, NORTHING))
    points = PointSet(np.column_stack([plan, hills(1)(*plan.T)]))
    np.testing.assert_array_equal(parametrize(points, SETTINGS, None).frame.axes, np.eye(3))


def test_holes_along_a_valley_predict_as_well_whichever_way_it_runs():
    ratios, at, origin = [], valley(0, 800, 1600, 200, 9), np.array((EASTING, NORTHING))
    for seed in range(6):
        truth, holes, errors = hills(seed, shortest=300.0), valley(0, seed=seed), []
        height, true = (truth(*(plan + origin).T) for plan in (holes, at))
        for azimuth in (0, 40):
            # The same holes in the same rock: only the axes of the map differ.
            a = np.radians(azimuth)
            turn = np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])
            points = PointSet(np.column_stack([holes @ turn + origin, height]))
            off = fit_horizon(points, SETTINGS).elevation(*(at @ turn + origin).T) - true
            assert np.isfinite(off).mean() > 0.95
            errors.append(rms(off[np.isfinite(off)]))
        ratios.append(errors[1] / errors[0])
    assert max(ratios) < 1.1, ratios


def test_a_steep_fault_is_met_over_its_best_plane():
    points = fault(72, n=300)
    surface = fit_horizon(points, FitSettings(core="none", interior_tolerance=0.05))
    assert surface.diagnostics["frame"] == "best-plane"
    assert surface.accuracy.max_abs < 0.06
    # Other points of the same fault, in its middle.
    inner = fault(72, n=900, seed=7)
    local = best_plane_frame(points).to_local(inner.xyz)[:, :2]
    inner = inner[(np.abs(local - local.mean(axis=0)) < 200).all(axis=1)]
    assert rms(surface.distance(inner.xyz)) < 0.1


@pytest.mark.parametrize("reverse", [(), (0, 3)])
def test_an_overturned_fold_is_met(reverse):
    surface = fit_horizon(folded(reverse=reverse))
    assert surface.diagnostics["frame"] == "sections"
    assert surface.accuracy.max_abs < 1e-6


def sharper(n=80):
    """A fold whose first hinge lies 15 m farther out than the second, and 400 other places on it."""
    rng = np.random.default_rng(3)
    points = folded(n=n)
    xyz = points.xyz.copy()
    between = fold_at(rng.uniform(0.05, 0.95, 400), rng.uniform(10, 290, 400)) + np.array((EASTING, NORTHING, 500))
    for places in (xyz, between):
        z = places[:, 2] - 500 - 6 * np.sin((places[:, 1] - NORTHING) / 70)
        places[:, 0] += 15 * np.exp(-(((z - 55) / 40) ** 2))
    return points.with_(xyz=xyz), between


def test_a_fold_linear_across_is_right_between_its_sections():
    points, between = sharper()
    surface = fit_horizon(points, FitSettings(across="linear"))
    assert rms(surface.distance(between)) < 0.3


def test_a_fold_cubic_across_is_right_between_its_sections():
    points, between = sharper()
    assert rms(fit_horizon(points).distance(between)) < 0.3


def test_a_symmetric_fold_is_right_between_its_sections():
    rng = np.random.default_rng(3)
    between = fold_at(rng.uniform(0.05, 0.95, 400), rng.uniform(10, 290, 400)) + np.array((EASTING, NORTHING, 500))
    assert rms(fit_horizon(folded()).distance(between)) < 2.0


def test_a_cloud_that_is_no_plane_is_laid_over_the_map():
    """Steep as a whole, but as thick across its best plane as that is wide: every place must keep an elevation."""
    rng = np.random.default_rng(4)
    a, d, w = rng.uniform(0, 300, 60), rng.uniform(0, 800, 60), rng.uniform(-80, 80, 60)
    points = PointSet(np.column_stack([a + EASTING, w + 0.2 * d + NORTHING, d]))
    parametrization = parametrize(points, SETTINGS, None)
    assert parametrization.frame.kind == "map"
    assert "fitting.frame-map-despite-dip" in {note.code for note in parametrization.notes}
    assert np.isfinite(fit_horizon(points).elevation(*points.xyz[:, :2].T)).all()


def twisted(first, last, missing=None):
    """A steep surface on eight sections, whose dip changes along its strike of 500 m to the other side of upright."""
    a = np.repeat(np.linspace(0, 500, 8), 25)
    d = np.tile(np.linspace(-110, 110, 25), 8)
    dip = np.radians(first + (last - first) * a / 500)
    xyz = np.column_stack([d * np.cos(dip) + 5 * np.sin(a / 60), a, d * np.sin(dip)])
    xyz[:, [0, 2]] += np.random.default_rng(5).normal(0, 0.05, (200, 2))
    points = PointSet(xyz + np.array((EASTING, NORTHING, 700)), section=np.repeat([f"S{k}" for k in range(8)], 25))
    return points if missing is None else points[points.section != missing]


@pytest.mark.parametrize("dips", [(60, 120), (60, 100), (65, 115), (60, 95)])
def test_a_twisted_surface_that_passes_upright_is_fitted_over_its_best_plane(dips):
    for missing in (None, "S0", "S3", "S7"):
        assert parametrize(twisted(*dips, missing), SETTINGS, None).frame.kind == "best-plane"


def test_a_twisted_surface_is_met():
    points = twisted(60, 120)
    surface = fit_horizon(points)
    assert with_code(surface.accuracy.notes, "fitting.frame-best-plane-turning-over")
    assert rms(surface.distance(points.xyz)) < 0.06


def test_a_steep_height_field_that_is_no_plane_stays_one_over_the_map():
    """Relief that is folded back over its best plane looks overturned there, and is not."""
    rng = np.random.default_rng(0)
    for wave in (60, 100, 160):
        plan = rng.uniform(0, 400, (250, 2))
        z = np.tan(np.radians(60)) * plan[:, 0] + 1.6 * wave * np.sin(plan[:, 0] / wave)
        points = PointSet(np.column_stack([plan + np.array((EASTING, NORTHING)), z]))
        assert not turns_over(points, best_plane_frame(points))


def test_the_note_on_a_steep_surface_over_the_map_names_the_frame_that_it_needs():
    """It scatters too far across its best plane for it to be chosen, and is met there and not over the map."""
    rng = np.random.default_rng(1)
    along, down = rng.uniform(0, [[300], [200]], (2, 300))
    height = 32.0 * np.sin(down / 25)
    dip = np.radians(62)
    rise = np.column_stack(
        [down * np.cos(dip) + height * np.sin(dip), along, height * np.cos(dip) - down * np.sin(dip)]
    )
    points = PointSet(rise + np.array((EASTING, NORTHING, 500)))
    (note, *_) = parametrize(points, SETTINGS, None).notes
    assert note.code == "fitting.frame-map-despite-dip"
    assert "frame='best-plane'" in note.template
    over_map, over_plane = (
        np.abs(fit_horizon(points, FitSettings(frame=frame)).accuracy.residuals).max()
        for frame in ("map", "best-plane")
    )
    assert over_map > 10
    assert over_plane < 0.1
