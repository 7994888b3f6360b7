"""T21, T26, T28-T31 of whole metamorphoses: ends, topology, parts that are not reached, dates, pace, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import refused

import geofit
import geofit.implicit as implicit
from geofit.data.errors import PointsError, SettingsError
from geofit.morphing.errors import MorphError

BALL = implicit.Sphere([0, 0, 0], 0.5)
RING = implicit.Torus([0, 0, 0], [0, 0, 1], 0.55, 0.22)
S_OPEN, BLEND_OPEN = 0.722306, 0.5 / (0.5 + 0.55 - 0.22)


def ball_mesh(
    radius: float = 1.0, at: tuple[float, float, float] = (0, 0, 0), cells: int = 32
) -> implicit.TriangleMesh:
    ball = implicit.Sphere(np.array(at, float), radius)
    return implicit.isosurface(
        ball, implicit.Lattice.around(*(np.array(b) * 1.0 for b in ball.bounds), cells=cells), capped=True
    )


def blobs(seed: int) -> implicit.Field:
    rng = np.random.default_rng(seed)
    return implicit.union(
        *(implicit.Sphere(rng.normal(0, 0.5, 3), r) for r in rng.uniform(0.4, 0.8, 5)), implicit.Sphere([0, 0, 0], 0.4)
    )


def test_arrival_is_linear_between_concentric_spheres() -> None:
    for a, b in ((0.3, 0.7), (0.7, 0.3)):
        m = geofit.morph(implicit.Sphere([0, 0, 0], a), implicit.Sphere([0, 0, 0], b), cells=48, pace="time")
        for s in (0.1, 0.37, 0.632, 0.9):
            radius = np.linalg.norm(m(s).mesh.vertices, axis=1)
            truth = a + s * (b - a)
            assert np.abs(radius - truth).max() <= max(0.005 * abs(b - a), 0.03 * m.lattice.spacing)
            assert abs(radius.mean() - truth) <= 0.02 * m.lattice.spacing
            assert abs(m(s).volume / (4 / 3 * np.pi * truth**3) - 1) <= 0.01


@pytest.mark.parametrize("gap", [0.4, 0.9, 1.7, 3.2])
def test_a_way_of_a_few_nodes_stays_smooth(gap: float) -> None:
    m = geofit.morph(
        implicit.Sphere([0, 0, 0], 1.0), implicit.Sphere([0, 0, 0], 1.0 + gap / 24), spacing=1 / 24, pace="time"
    )
    for s in (0.25, 0.5, 0.75):
        radius = np.linalg.norm(m(s).mesh.vertices, axis=1)
        assert np.abs(radius - 1.0 - s * gap / 24).max() <= 0.06 * m.lattice.spacing


@pytest.mark.parametrize(("mode", "opens", "share"), [("arrival", S_OPEN, 0.01), ("blend", BLEND_OPEN, 0.01)])
def test_the_hole_opens_once_and_when_it_has_to(mode: str, opens: float, share: float) -> None:
    m = geofit.morph(BALL, RING, mode=mode, cells=96, pace="time")
    (event,) = m.events
    assert event.euler == (2, 0)
    assert event.components == (1, 1)
    assert abs(event.tau - opens) <= share * opens


BIG, TWINS = (
    implicit.Sphere([0, 0, 0], 0.8),
    implicit.union(implicit.Sphere([-0.7, 0, 0], 0.45), implicit.Sphere([0.7, 0, 0], 0.45)),
)
#: The linear blend splits where it is 0 at the middle; the arrival when the neck's radius has run from 0.8 to 0.
BLEND_SPLIT = 0.8 / (0.8 + 0.7 - 0.45)
NECK = np.linspace(0, 0.8, 4001)
ARRIVAL_SPLIT = 1 - np.exp(-np.trapezoid(1 / (np.hypot(0.7, NECK) - 0.45), NECK))


@pytest.mark.parametrize(
    ("mode", "first", "last", "at", "components", "euler"),
    [
        ("blend", BIG, TWINS, BLEND_SPLIT, (1, 2), (2, 4)),
        ("blend", TWINS, BIG, 1 - BLEND_SPLIT, (2, 1), (4, 2)),
        ("arrival", BIG, TWINS, ARRIVAL_SPLIT, (1, 2), (2, 4)),
        ("blend", BIG, implicit.difference(implicit.Sphere([0, 0, 0], 0.9), implicit.Sphere([0, 0, 0], 0.4)),
         0.8 / (0.8 + 0.4), (1, 1), (2, 4)),
    ],
    ids=["split", "merge", "split of an arrival", "cavity"],
)  # fmt: skip
def test_parts_split_merge_and_get_a_cavity_when_they_have_to(
    mode: str,
    first: implicit.Field,
    last: implicit.Field,
    at: float,
    components: tuple[int, int],
    euler: tuple[int, int],
) -> None:
    (event,) = geofit.morph(first, last, mode=mode, cells=64, pace="time").events
    assert event.components == components
    assert event.euler == euler
    assert abs(event.tau - at) <= 0.02


def test_no_islands_appear_where_both_surfaces_meet() -> None:
    m = geofit.morph(BALL, RING, cells=48, pace="time")
    for tau, lines in ((0.02, 1), (0.3, 1), (0.6, 1), (0.8, 2), (0.95, 2)):
        found = implicit.field_contours(
            m(tau).field, [-0.85, 0, -0.6], [1, 0, 0], [0, 0, 1], size=(1.7, 1.2), spacing=0.01
        )
        assert len(found) == lines


def test_the_level_set_mode_opens_the_hole_too_and_keeps_its_energy_falling() -> None:
    m = geofit.morph(BALL, RING, mode="pde", cells=40, pace="time", eps=0.0)
    (event,) = m.events
    assert event.euler == (2, 0)
    assert abs(event.tau - S_OPEN) <= 0.02
    steps = m.legs[0].path.steps
    assert (np.diff(steps[:, 2]) <= 0).all()
    assert (np.diff(steps[:, 3]) <= 0).all()


@pytest.mark.parametrize(
    ("mode", "seed"), [*(("arrival", seed) for seed in range(5)), *(("pde", seed) for seed in (0, 1, 3))]
)
def test_nothing_leaves_the_corridor(mode: str, seed: int) -> None:
    cells = 48 if mode == "arrival" else 28
    m = geofit.morph(blobs(seed), blobs(seed + 50), mode=mode, cells=cells, eps=0.0)
    for row in m.table(7):
        assert row.drift <= 1e-4 * m(1.0).volume
    for body in m.frames(7):
        assert body.overview.is_closed
        assert body.overview.is_manifold


def test_the_ends_are_the_given_bodies() -> None:
    a, b = ball_mesh(1.0), ball_mesh(1.2, (0.3, 0, 0))
    m = geofit.morph(a, b, cells=32)
    assert m(0).mesh is a
    assert m(1).mesh is b
    assert m(0.0).given is a
    assert not m(1.0).interpolated
    back = geofit.morph(a, b, a, cells=32)
    assert [body.given for body in back.frames(3)] == [a, b, a]
    f = geofit.morph(BALL, RING, cells=32)
    assert f(0).field is BALL
    assert f(1).field is RING


def test_a_body_on_its_way_to_itself_does_not_move() -> None:
    m = geofit.morph(RING, RING, cells=48)
    assert np.abs(RING.value(m(0.4).overview.vertices)).max() <= 1e-3 * m.lattice.spacing
    for mode in ("pde", "blend"):
        other = geofit.morph(RING, implicit.Torus([0, 0, 0], [0, 0, 1], 0.55, 0.22), mode=mode, cells=48)
        assert np.abs(RING.value(other(0.4).overview.vertices)).max() <= 1e-3 * other.lattice.spacing


def test_a_ball_that_is_not_touched_is_named_before_and_reached_from_a_seed() -> None:
    a, b = implicit.Sphere([0, 0, 0.3], 1.3), implicit.union(BALL_1, implicit.Sphere([3, 0, 0], 1))
    m = geofit.morph(a, b, cells=64)
    (part,) = m.unreached
    assert part.volume == pytest.approx(4 / 3 * np.pi, rel=0.05)
    np.testing.assert_allclose(part.deepest, [3, 0, 0], atol=2 * m.lattice.spacing)
    assert [body.components for body in m.frames(4)] == [1, 1, 1, 2]
    seeded = geofit.morph(a, b, cells=64, seeds=True)
    assert not seeded.unreached
    assert seeded(0.5).components == 2
    given = geofit.morph(a, b, cells=64, seeds=[[3.1, 0.1, 0]])
    assert not given.unreached
    away = geofit.morph(b, a, cells=64)
    (part,) = away.vanishing
    assert part.kind == "vanishing"
    assert away(0.2).components == 2
    assert away(0.99).components == 1


BALL_1 = implicit.Sphere([0, 0, 0], 1)


def test_places_of_seeds_are_named_where_they_are_none() -> None:
    with pytest.raises(PointsError, match=r"seeds has shape \(1, 2\)"):
        geofit.morph(BALL_1, BALL_1, cells=16, seeds=[[3.1, 0.1]])


def test_bodies_that_do_not_touch_need_seeds_or_a_blend() -> None:
    far = implicit.Sphere([4, 0, 0], 1)
    with pytest.raises(MorphError) as caught:
        geofit.morph(BALL_1, far, cells=32)
    assert caught.value.code == "morphing.nothing-reached"
    assert geofit.morph(BALL_1, far, cells=32, seeds=True)(0.9).components >= 1
    assert geofit.morph(BALL_1, far, cells=32, mode="blend").unreached


def test_pace_by_volume_and_by_progress() -> None:
    small, large = implicit.Sphere([0, 0, 0], 1), implicit.Sphere([0.2, 0, 0], 1.6)
    m = geofit.morph(small, large, cells=64, pace="volume")
    low, high = (4 / 3 * np.pi * r**3 for r in (1, 1.6))
    for tau in (0.2, 0.5, 0.8):
        assert m(tau).volume == pytest.approx((1 - tau) * low + tau * high, rel=0.005)
    even = geofit.morph(small, large, cells=64)
    done = [row.gain for row in even.table(5)]
    np.testing.assert_allclose(np.diff(done), (high - low) / 4, rtol=0.03)
    with pytest.raises(MorphError) as caught:
        geofit.morph(BALL, RING, cells=48, pace="volume")(0.5)
    assert caught.value.code == "morphing.volume-not-monotone"


def bench(height: float) -> implicit.TriangleMesh:
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    corners = np.array(list(np.ndindex(2, 2, 2)), float) * [32.0, 32.0, height]
    return implicit.TriangleMesh(corners, [[f[0], f[k], f[k + 1]] for f in faces for k in (1, 2)])


@pytest.mark.parametrize("mode", ["arrival", "blend", "pde"])
@pytest.mark.parametrize(("before", "after"), [(9.0, 7.0), (9.0, 8.6)])
def test_a_level_along_the_lattice_falls_evenly(mode: str, before: float, after: float) -> None:
    m = geofit.morph(bench(before), bench(after), mode=mode, spacing=1.0, dates=["2020-01-01", "2021-01-01"])
    levels = before + (after - before) * np.linspace(0.1, 0.9, 9)
    off = [m(tau).distance([[16.0, 16.0, z]])[0] for tau, z in zip(np.linspace(0.1, 0.9, 9), levels, strict=True)]
    np.testing.assert_allclose(off, 0, atol=0.08 * (before - after))
    leg = m.legs[0]
    for p in (0.1, 0.45, 0.8):
        assert leg.progress(leg.share_at_progress(p)) == pytest.approx(p, abs=1e-6)


def test_the_volume_sets_the_pace_where_faces_run_along_the_lattice() -> None:
    m = geofit.morph(bench(9), bench(7), spacing=1.0, pace="volume")
    leg = m.legs[0]
    first, last = leg.volume(0.0), leg.volume(1.0)
    for p in (0.1, 0.45, 0.5, 0.55, 0.9):
        assert leg.volume(leg.share_at_volume(p)) == pytest.approx((1 - p) * first + p * last, abs=1e-4 * first)


def test_dates_set_the_pace_and_nothing_is_extrapolated() -> None:
    bodies = [implicit.Sphere([500_000, 3_000_000, 120], r) for r in (10.0, 12.0, 11.0)]
    m = geofit.morph(*bodies, dates=["2020-01-01", "2021-01-01", "2024-01-01"], cells=48, sd=[0.05, 0.05, 0.1])
    assert m("2021-01-01").given is bodies[1]
    assert m.alignment is not None
    assert not m.alignment.applied
    assert m.alignment.distance < 0.1 * m.lattice.spacing
    middle = m("2020-07-02")
    assert middle.date.isoformat() == "2020-07-02"
    assert 10 < (middle.volume * 0.75 / np.pi) ** (1 / 3) < 12
    grown, shrunk = m.changes
    truth = 4 / 3 * np.pi * (12**3 - 10**3)
    assert grown.net == pytest.approx(truth, rel=0.01)
    assert grown.rate == pytest.approx(truth / (366 / 365.25), rel=0.01)
    assert grown.net_sd == pytest.approx(4 * np.pi * np.hypot(0.05 * 100, 0.05 * 144), rel=0.01)
    assert [part.detected for part in grown.parts] == [True]
    assert shrunk.gain < 1e-3 * shrunk.loss
    with pytest.raises(SettingsError) as caught:
        m("2024-06-01")
    assert caught.value.code == "morphing.beyond-surveys"


def test_a_change_within_the_error_of_the_surveys_is_not_detected() -> None:
    m = geofit.morph(implicit.Sphere([0, 0, 0], 5), implicit.Sphere([0, 0, 0], 5.2), cells=64, sd=[0.1, 0.1])
    (part,) = m.changes[0].parts
    assert part.detected is False
    assert part.thickness == pytest.approx(0.2, rel=0.05)


@pytest.mark.parametrize("dates", [["2020-01-01"], ["2021-01-01", "2020-01-01"], ["2020-01-01", "soon"]])
def test_dates_that_make_no_sense_are_refused(dates: list[str]) -> None:
    with pytest.raises(MorphError):
        geofit.morph(BALL, RING, dates=dates)


def test_open_and_inconsistent_meshes_are_refused_with_their_edges() -> None:
    ball = ball_mesh()
    hole = ball.only(np.arange(len(ball.triangles)) != 7)
    with pytest.raises(MorphError) as caught:
        geofit.morph(hole, ball)
    assert caught.value.code == "morphing.mesh-open"
    a, b = hole.boundary_edges[0].tolist()
    assert f"{a}-{b} (" in str(caught.value)
    turned = ball.triangles.copy()
    turned[3] = turned[3][::-1]
    with pytest.raises(MorphError) as caught:
        geofit.morph(ball, implicit.TriangleMesh(ball.vertices, turned))
    assert caught.value.code == "morphing.mesh-inconsistent"
    assert str(caught.value).endswith("Repair it in the program that made it.")


@pytest.mark.parametrize(
    "settings",
    [{"mode": "magic"}, {"pace": "slow"}, {"cells": 3}, {"spacing": -1.0}, {"eps": -1.0}, {"sd": [0.1]},
     {"align": "axes"}, {"align": "principal", "dates": ["2020-01-01", "2021-01-01"]}, {"spacing": 1e-5}],
)  # fmt: skip
def test_settings_out_of_range_are_refused(settings: dict) -> None:
    with pytest.raises(SettingsError):
        geofit.morph(BALL, RING, **settings)


def test_mirrored_meshes_and_map_coordinates_do_not_matter() -> None:
    away = np.array([512_345.0, 4_012_345.0, 678.0])
    a, b = ball_mesh(1.0), ball_mesh(1.5)
    near = geofit.morph(a, b, cells=40)
    inverted = implicit.TriangleMesh(a.vertices + away, a.triangles[:, ::-1])
    far = geofit.morph(inverted, implicit.TriangleMesh(b.vertices + away, b.triangles), cells=40)
    assert far(0.5).volume == pytest.approx(near(0.5).volume, rel=1e-3)
    np.testing.assert_allclose(far(0.5).mesh.vertices.mean(axis=0), away, atol=0.05)


@pytest.mark.parametrize("turn", [[0.4, 0.3, -0.9], [0, 0, np.pi], [2.0, 1.0, 0.5]])
def test_alignment_finds_a_known_similarity_and_starts_where_the_body_is(turn: list[float]) -> None:
    from scipy.spatial.transform import Rotation

    rotation = Rotation.from_rotvec(turn).as_matrix()
    a = implicit.union(
        implicit.ellipsoid([0, 0, 0], [2.0, 1.0, 0.6]),
        implicit.Sphere([1.5, 0.5, 0.3], 0.8),
        implicit.Sphere([-1, -0.4, 0], 0.7),
    )
    b = implicit.moved(a, rotation, [1.0, 2.0, -0.5])
    m = geofit.morph(a, b, align="principal", cells=64)
    assert m.alignment.applied
    assert m.alignment.after >= 0.99
    off = Rotation.from_matrix(m.alignment.rotation.T @ rotation).magnitude()
    assert np.degrees(off) <= 0.5
    assert abs(m.alignment.scale - 1) <= 0.01
    assert m(0).field is a
    quarter = m(0.25)
    assert quarter.volume == pytest.approx(m(0).volume, rel=0.02)
    assert quarter.overview.is_closed
    early = m(1e-6).overview.vertices
    assert np.abs(implicit.signed_distance(a, early)).max() <= 0.5 * m.lattice.spacing


def test_two_surveys_above_a_common_base() -> None:
    class Dome:
        def __init__(self, height: float, ground: float = 100.0) -> None:
            self.height, self.ground = height, ground

        def elevation(self, x, y):
            return self.ground + self.height * np.exp(-((x - 50) ** 2 + (y - 50) ** 2) / 400)

    area = ((0, 0), (100, 100))
    before, after = (geofit.between(Dome(h), 90.0, area=area, name=str(h)) for h in (20.0, 12.0))
    m = geofit.morph(before, after, cells=80)
    assert m(0).volume == pytest.approx(100 * 100 * 10 + 20 * np.pi * 400, rel=0.01)
    assert m.changes[0].loss == pytest.approx(8 * np.pi * 400, rel=0.03)
    assert m.changes[0].gain <= 0.02 * m.changes[0].loss
    middle = m(0.5)
    assert middle.overview.is_closed
    assert middle.volume == pytest.approx((m(0).volume + m(1).volume) / 2, rel=0.002)
    pieces = middle.cut({"bench": Dome(0.0, 102.0)})
    assert sum(piece.volume for piece in pieces) == pytest.approx(middle.volume, rel=1e-6)
    with pytest.raises(MorphError):
        geofit.between(80.0, Dome(5.0), area=area)
    with pytest.raises(SettingsError):
        geofit.between(80.0, 70.0)


def test_the_same_bodies_make_the_same_bytes() -> None:
    one, two = (geofit.morph(blobs(3), blobs(9), cells=32)(0.4).mesh for _ in range(2))
    assert one.vertices.tobytes() == two.vertices.tobytes()
    assert one.triangles.tobytes() == two.triangles.tobytes()


def test_bodies_of_other_coordinates_are_refused() -> None:
    with pytest.raises(MorphError) as caught:
        geofit.morph(implicit.Sphere([0, 0, 0], 5.0), implicit.Sphere([500_000, 3_100_000, 0], 5.0), cells=24)
    assert caught.value.code == "morphing.bodies-far-apart"


def box_mesh(lower: tuple[float, float, float], upper: tuple[float, float, float]) -> implicit.TriangleMesh:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = [three for a, b, c, d in faces for three in ((a, b, c), (a, c, d))]
    return implicit.TriangleMesh(np.array(lower) + corners * np.subtract(upper, lower), np.array(triangles))


def joined(*meshes: implicit.TriangleMesh) -> implicit.TriangleMesh:
    counts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    triangles = [mesh.triangles + first for mesh, first in zip(meshes, counts, strict=False)]
    return implicit.TriangleMesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(triangles))


def test_a_cavity_is_not_a_part() -> None:
    block, hollow = box_mesh((0, 0, 0), (40, 30, 20)), box_mesh((10, 10, 5), (30, 20, 15))
    cavity = implicit.TriangleMesh(hollow.vertices, hollow.triangles[:, ::-1])
    m = geofit.morph(block, joined(block, cavity), cells=32)
    assert [row.components for row in m.table(3)] == [1, 1, 1]
    assert [(event.components, event.euler) for event in m.events] == [((1, 1), (2, 4))]


def test_overlapping_parts_without_a_front_are_refused(recwarn: pytest.WarningsRecorder) -> None:
    block = box_mesh((0, 0, 0), (40, 30, 20))
    with refused(MorphError, "morphing.front-unbounded", earlier=1, later=2):
        geofit.morph(block, joined(block, box_mesh((20, 0, 0), (60, 30, 20))), cells=48)
    assert not recwarn.list
