"""Bodies of passages against closed forms and a plain reference."""

from __future__ import annotations

import numpy as np
import pytest
from cave_surveys import chain, network

from geofit.caves.body import PassageBody, centreline_body
from geofit.caves.shots import ShotList
from geofit.caves.sweep_loops import paint_sweeps
from geofit.data.errors import SettingsError
from geofit.implicit.field import Field, RangedField

LINE = np.array([[0, 0, 0], [20, 5, 3], [40, 10, 6]], float)
LENGTH = float(np.linalg.norm(LINE[-1]))


def plain(body: PassageBody, points):
    """The union, sweep by sweep in numpy, the two nearest branches blended."""
    s, values = body.sweeps, []
    for n in range(len(s.length)):
        q = points - s.origin[n]
        x, v, w = q @ s.along[n], q @ s.right[n], q @ s.up[n]
        t = np.clip(x / s.length[n], 0, 1)[:, None]
        axes = (1 - t) * s.walls[n, 0] + t * s.walls[n, 1]
        a, b = np.where(v >= 0, axes[:, 1], axes[:, 0]), np.where(w >= 0, axes[:, 2], axes[:, 3])
        over = np.maximum(np.maximum(-x, x - s.length[n]), 0)
        cap = np.where(x < 0, s.cap[n, 0], s.cap[n, 1])
        plane = np.maximum(-x if s.cap[n, 0] == 0 else -np.inf, x - s.length[n] if s.cap[n, 1] == 0 else -np.inf)
        over = np.where(cap == 0, 0, over)
        away = np.sqrt(v**2 + w**2 + over**2)
        rho = np.sqrt((v / a) ** 2 + (w / b) ** 2 + (over / np.where(cap == 0, 1, cap)) ** 2)
        found = np.maximum(away - away / rho, plane)
        # Beyond a bend the next shot counts.
        beyond = np.where((x < 0)[:, None], s.onward[n, 0], s.onward[n, 1])
        tip = np.where((x < 0)[:, None], q, q - s.length[n] * s.along[n])
        values.append(np.where(((x < 0) | (x > s.length[n])) & ((tip * beyond).sum(axis=1) > 0), np.inf, found))
    values = np.array(values)
    by_branch = np.array([values[s.branch == k].min(axis=0) for k in np.unique(s.branch)])
    by_branch.sort(axis=0)
    if len(by_branch) == 1 or body.blend == 0:
        return by_branch[0]
    gap = np.maximum(body.blend - (by_branch[1] - by_branch[0]), 0)
    return by_branch[0] - gap**2 / (4 * body.blend)


def branching(seed):
    _, survey = network(seed, stations=14, extra=3, noise=0.0)
    rng = np.random.default_rng(seed)
    shots = ShotList(fixed={"0": (0.0, 0.0, 0.0)})
    for k in range(len(survey.start)):
        a, b = survey.stations[survey.start[k]], survey.stations[survey.end[k]]
        shots.add_walls(a, shots.add(a, b, survey.offset[k], k), rng.uniform(0.3, 3, 4).tolist())
    return shots.survey("branching"), rng


@pytest.mark.parametrize("ends", ["round", "flat"])
@pytest.mark.parametrize("seed", range(4))
def test_values_equal_plain_numpy(seed, ends):
    survey, rng = branching(seed)
    body = centreline_body(survey, ends=ends)
    assert isinstance(body, Field)
    assert isinstance(body, RangedField)
    low, high = body.bounds
    points = rng.uniform(low - 5, high + 5, (3000, 3))
    np.testing.assert_allclose(body.value(points), plain(body, points), atol=1e-9)


@pytest.mark.parametrize("ends", ["round", "flat"])
def test_ranges_contain_the_values(ends):
    survey, rng = branching(5)
    body = centreline_body(survey, ends=ends)
    low = rng.uniform(*body.bounds, (100, 3))
    high = low + rng.uniform(0.2, 8, (100, 3))
    least, most = body.range_in(low, high)
    for k in range(100):
        values = body.value(rng.uniform(low[k], high[k], (100, 3)))
        assert least[k] - 1e-9 <= values.min()
        assert values.max() <= most[k] + 1e-9


@pytest.mark.parametrize("radius", [0.8, 2.0, 5.0])
def test_a_straight_tube_has_its_volume(radius):
    tube = np.pi * radius**2 * LENGTH
    flat = centreline_body(chain(LINE, radius), ends="flat")
    assert flat.volume(radius / 12) == pytest.approx(tube, rel=0.003)
    assert flat.sweeps.volumes.sum() == pytest.approx(tube, rel=1e-12)
    round_ = centreline_body(chain(LINE, radius))
    capsule = tube + 4 / 3 * np.pi * radius**3
    assert round_.volume(radius / 12) == pytest.approx(capsule, rel=0.003)
    mesh = round_.triangulate(radius / 5)
    assert mesh.is_closed
    assert mesh.euler == 2
    assert mesh.volume == pytest.approx(capsule, rel=0.015)


DIRECTIONS = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 0.3), (0.5, 0.3, -0.2), (0.02, 1, 0.01)]


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize(("radius", "length"), [(2.0, 50.0), (1.37, 23.7)])
def test_the_default_spacing_gives_the_volume_in_any_direction(direction, radius, length):
    """A tunnel along an axis crosses all cells of the lattice at the same place, so errors do not cancel."""
    end = length * np.array(direction) / np.linalg.norm(direction)
    tube = np.pi * radius**2 * length
    assert centreline_body(chain([[0, 0, 0], end], radius), ends="flat").volume() == pytest.approx(tube, rel=0.004)
    capsule = tube + 4 / 3 * np.pi * radius**3
    assert centreline_body(chain([[0, 0, 0], end], radius)).volume() == pytest.approx(capsule, rel=0.004)


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_flat_or_eccentric_section_has_its_volume_in_any_direction(direction):
    end = 40 * np.array(direction) / np.linalg.norm(direction)
    for walls in ([4.0, 4.0, 0.8, 0.8], [1.0, 3.0, 2.0, 0.6]):
        shots = ShotList(across=True, fixed={"a": (0.3, 0.1, 0.7)})
        shot = shots.add("a", "b", end, 0)
        shots.add_walls("a", shot, walls)
        shots.add_walls("b", shot, walls)
        body = centreline_body(shots.survey("section"), ends="flat")
        assert body.volume() == pytest.approx(body.sweeps.volumes[0], rel=0.01)


@pytest.mark.parametrize("direction", [(1, 0, 0), (1, 1, 0), (0.9, 0.1, 0.3)])
@pytest.mark.parametrize("walls", [[0.15, 0.15, 10.0, 10.0], [8.0, 8.0, 0.2, 0.2]])
def test_a_slot_has_its_volume_at_the_cost_of_its_walls(monkeypatch, direction, walls):
    """A slot fills little of the box round its height, and cells by its width would be millions along its walls."""
    sizes = []

    def counted(sweeps, blend, boxes, origin, spacing, shape):
        sizes.append((np.prod(shape), spacing))
        return paint_sweeps(sweeps, blend, boxes, origin, spacing, shape)

    monkeypatch.setattr("geofit.caves.columns.paint_sweeps", counted)
    shots = ShotList(across=True, fixed={"a": (0.3, 0.1, 0.7)})
    shot = shots.add("a", "b", 25 * np.array(direction) / np.linalg.norm(direction), 0)
    shots.add_walls("a", shot, walls)
    shots.add_walls("b", shot, walls)
    body = centreline_body(shots.survey("slot"), ends="flat")
    assert body.volume() == pytest.approx(body.sweeps.volumes[0], rel=0.002)
    assert max(spacing for _, spacing in sizes) <= 3 * body.fine
    low, high = body.bounds
    assert sum(nodes for nodes, _ in sizes) < 0.1 * np.prod((high - low) / body.fine)


def test_slabs_of_any_size_add_up_to_the_same_volume(monkeypatch):
    body = centreline_body(branching(3)[0])
    whole = body.volume(0.5)
    for nodes in (3_000, 200_000):
        monkeypatch.setattr("geofit.caves.columns.NODES", nodes)
        assert body.volume(0.5) == pytest.approx(whole, rel=1e-12)


@pytest.mark.parametrize("points", [LINE, [[0, 0, 0], [0, 0, 50], [40, 0, 50]], [[0, 0, 0], [90, 70, 8], [0, 150, 30]]])
def test_tiles_give_the_volume_of_one_lattice(monkeypatch, points):
    body = centreline_body(chain(points, 2.0))
    tiled = [body.volume(0.5)]
    for tile in (7, 100_000):
        monkeypatch.setattr("geofit.caves.columns.TILE", tile)
        tiled.append(body.volume(0.5))
    np.testing.assert_allclose(tiled, tiled[0], rtol=1e-12)


def test_the_rock_that_no_passage_comes_near_costs_nothing(monkeypatch):
    """A shot of 1.4 km at 45 degrees: its box has 650 million nodes."""
    painted = []

    def counted(sweeps, blend, boxes, origin, spacing, shape):
        painted.append(np.prod(shape))
        return paint_sweeps(sweeps, blend, boxes, origin, spacing, shape)

    monkeypatch.setattr("geofit.caves.columns.paint_sweeps", counted)
    body = centreline_body(chain([[0, 0, 0], [1000, 1000, 0]], 1.0))
    assert body.volume() == pytest.approx(body.sweeps.volumes[0], rel=0.01)
    assert sum(painted) < 4e7


def test_coarse_and_fine_lattices_agree_on_branching_passages():
    for seed in range(3):
        body = centreline_body(branching(seed)[0])
        assert body.volume(0.4) == pytest.approx(body.volume(0.15), rel=0.01)


def test_the_distance_of_a_round_tube_is_exact():
    body = centreline_body(chain(LINE, 2.0))
    rng = np.random.default_rng(0)
    points = rng.uniform(-10, 50, (1000, 3))
    t = np.clip(points @ LINE[-1] / LENGTH**2, 0, 1)
    np.testing.assert_allclose(
        body.value(points), np.linalg.norm(points - t[:, None] * LINE[-1], axis=1) - 2, atol=1e-9
    )
    np.testing.assert_allclose(np.linalg.norm(body.gradient(points), axis=1), 1, atol=1e-5)


def test_a_ring_of_stations_is_a_torus():
    angle = np.linspace(0, 2 * np.pi, 97)[:-1]
    ring = np.column_stack([30 * np.cos(angle), 30 * np.sin(angle), 0 * angle])
    body = centreline_body(chain(ring, 3.0, closed=True))
    assert body.volume(0.25) == pytest.approx(2 * np.pi**2 * 30 * 9, rel=0.005)
    assert body.triangulate(1.0).euler == 0
    assert body.adjusted.loops[0].distance < 1e-9


def test_sections_of_four_quarter_ellipses_and_a_taper():
    shots = ShotList(across=True)
    shot = shots.add("a", "b", np.array([30.0, 0, 0]), 0)
    shots.add_walls("a", shot, [1, 2, 3, 0.5])
    shots.add_walls("b", shot, [2, 3, 1, 1.5])
    body = centreline_body(shots.survey("lens"), ends="flat")
    x = np.linspace(0, 30, 100_001)
    width, height = 3 + 2 * x / 30, 3.5 - x / 30
    assert body.sweeps.volumes[0] == pytest.approx(np.trapezoid(np.pi / 4 * width * height, x), rel=1e-8)
    assert body.volume(0.1) == pytest.approx(body.sweeps.volumes[0], rel=0.004)
    # North is left of a shot to the east.
    on = np.array([[0.0, 1, 0], [0, -2, 0], [0, 0, 3], [30, 2, 0], [30, -3, 0], [30, 0, -1.5]])
    np.testing.assert_allclose(body.value(on), 0, atol=1e-9)


def test_vertical_walls_of_a_sloping_cave_passage():
    """Sections in vertical planes: the volume is their area times the horizontal length."""
    survey = chain([[0, 0, 0], [20, 0, 20]], 2.0, across=False)
    body = centreline_body(survey, ends="flat")
    assert body.sweeps.volumes.sum() == pytest.approx(np.pi * 4 * 20, rel=1e-9)
    shaft = centreline_body(chain([[0, 0, 0], [0, 0, -20]], 2.0, across=False), ends="flat")
    assert shaft.sweeps.volumes.sum() == pytest.approx(np.pi * 4 * 20, rel=1e-9)


def sized(points, walls):
    """A tunnel with walls (n, 4) across it, left, right, up and down, at each of its points."""
    shots = ShotList(across=True)
    for k in range(len(points) - 1):
        shot = shots.add(str(k), str(k + 1), np.subtract(points[k + 1], points[k]), k)
        shots.add_walls(str(k), shot, walls[k])
    shots.add_walls(str(len(points) - 1), shot, walls[-1])
    return centreline_body(shots.survey("sized"), ends="flat")


@pytest.mark.parametrize("step", [2.0, 4.0, 8.0])
def test_a_wide_station_does_not_fill_the_narrow_ones_next_to_it(step):
    """The cap of the wide end reached over the next stations: up to 2.7 times the volume between the measured walls."""
    points = np.outer(np.arange(9) * step, [0.6, 0.8, 0.0])
    body = sized(points, [[5.0] * 4 if k % 2 else [1.0] * 4 for k in range(9)])
    assert body.volume() == pytest.approx(body.sweeps.volumes.sum(), rel=0.01)
    narrow = points[4] + np.outer([0.9, 1.1], [0.8, -0.6, 0.0])
    assert (body.value(narrow) < 0).tolist() == [True, False]


@pytest.mark.parametrize("angle", [20, 45, 90])
@pytest.mark.parametrize("walls", [[0.25, 0.25, 5.0, 5.0], [1.5, 1.5, 1.5, 1.5]])
def test_a_bend_does_not_reach_through_its_wall(angle, walls):
    """A slot 0.5 m wide and 10 m high that turns had spikes of 2.6 m at each bend, half of its volume more."""
    half = np.radians(angle / 2)
    turns = [[5 * np.cos(half), 5 * np.sin(half) * (-1) ** k, 0.0] for k in range(10)]
    body = sized(np.vstack([np.zeros(3), np.cumsum(turns, axis=0)]), [walls] * 11)
    assert body.volume() == pytest.approx(body.sweeps.volumes.sum(), rel=0.03)
    # The outer side of a bend is filled as far as the wall.
    corner, out = np.sum(turns[:1], axis=0), np.array([0.0, 1.0, 0.0])
    for reach, inside in ((0.95, True), (1.1, False)):
        assert bool(body.value([corner + reach * walls[0] * out])[0] < 0) == inside


def test_a_junction_swells_by_no_more_than_the_blend_allows():
    shots = ShotList(across=True)
    for row, end in enumerate(([20.0, 0, 0], [-10, 17, 0], [-10, -17, 0])):
        shots.add_walls(f"{row}", shots.add("j", f"{row}", np.array(end), row), [2.0] * 4)
    shots.add_walls("j", 0, [2.0] * 4)
    survey = shots.survey("Y")
    sharp, smooth = centreline_body(survey, blend=0.0), centreline_body(survey, blend=1.0)
    points = np.random.default_rng(0).uniform(-20, 20, (4000, 3))
    sunk = sharp.value(points) - smooth.value(points)
    assert sunk.min() >= 0
    assert sunk.max() <= 0.25 + 1e-12
    assert 1.0 < smooth.volume(0.25) / sharp.volume(0.25) < 1.02
    assert len(np.unique(sharp.sweeps.branch)) == 3


def test_a_y_of_tunnels_has_its_volume():
    """PORES.md, test 34: three round tunnels in a plane; their union by counting."""
    ends = np.array([[20.0, 0, 0], [-10, 10 * np.sqrt(3), 0], [-10, -10 * np.sqrt(3), 0]])
    shots = ShotList(across=True)
    for row, end in enumerate(ends):
        shots.add_walls(f"{row}", shots.add("j", f"{row}", end, row), [2.0] * 4)
    shots.add_walls("j", 0, [2.0] * 4)
    body = centreline_body(shots.survey("Y"), blend=0.0)
    # A capsule a way, counted on a lattice four times as fine as the body's.
    step = 0.05
    z = np.arange(step / 2, 2.2, step)
    x, y = np.meshgrid(np.arange(-12.5, 22.5, step), np.arange(0.0, 20.0, step) + step / 2, indexing="ij")
    nearest = np.full(x.shape, np.inf)
    for end in ends / 20:
        t = np.clip(x * end[0] + y * end[1], 0, 20)
        nearest = np.minimum(nearest, np.hypot(x - t * end[0], y - t * end[1]))
    truth = 4 * step**3 * sum(np.count_nonzero(nearest**2 + height**2 < 4) for height in z)
    assert body.volume(0.2) == pytest.approx(truth, rel=0.01)


def test_thin_passages_are_named():
    body = centreline_body(chain([[0, 0, 0], [9, 0, 0], [18, 0, 0], [27, 0, 0]], [2.0, 2.0, 0.2, 2.0]))
    assert body.thinner_than(0.5) == (("1", "2"), ("2", "3"))
    assert body.thinner_than(0.3) == ()


def test_settings_are_checked():
    survey = chain(LINE, 1.0)
    with pytest.raises(SettingsError, match="'round' or 'flat'"):
        centreline_body(survey, ends="open")
    with pytest.raises(SettingsError, match="blend"):
        centreline_body(survey, blend=-1)
    with pytest.raises(SettingsError, match="spacing"):
        centreline_body(survey).volume(0.0)


def test_a_shot_that_was_surveyed_again_changes_nothing():
    """It was taken for a branch of its own: its end swelled, or bulged out of a flat end."""
    tube, places = [2.0] * 4, np.array([[0, 0, 0], [10, 0, 0], [20, 0, 0], [30, 0, 0]], float)
    bodies = []
    for again in ((), ((0, 1),), ((2, 1),), ((0, 1), (1, 0), (3, 2))):
        shots = ShotList()
        for a, b in (*((k, k + 1) for k in range(3)), *again):
            shot = shots.add(str(a), str(b), places[b] - places[a], 1)
            shots.add_walls(str(a), shot, tube)
            shots.add_walls(str(b), shot, tube)
        bodies.append(centreline_body(shots.survey("tube"), ends="flat"))
    at = np.random.default_rng(0).uniform([-3, -4, -4], [33, 4, 4], (500, 3))
    for body in bodies[1:]:
        np.testing.assert_allclose(body.value(at), bodies[0].value(at), atol=1e-9)


def test_a_wide_passage_does_not_reach_into_narrow_branches():
    """Its cap bulged by its own radius where two or more others go on: 16 % of the volume here."""
    shots = ShotList(across=True, fixed={"0": (0.0, 0.0, 0.0)})
    ends = [("0", "1", (0, 20, 0), 5.0), ("1", "2", (0, 20, 0), 0.5), ("1", "3", (20, 1, 0), 0.5)]
    for row, (a, b, offset, radius) in enumerate(ends):
        shot = shots.add(a, b, np.array(offset, float), row)
        for station in (a, b):
            shots.add_walls(station, shot, [radius] * 4)
    body = centreline_body(shots.survey("wide"), ends="flat", blend=0)
    true = np.pi * (25 * 20 + 0.25 * 20 + 0.25 * 15)
    assert body.volume(0.15) == pytest.approx(true, rel=0.02)
