"""A layer has one volume, whoever states it: the order, the grid of its thickness, the triangles of its body."""

from __future__ import annotations

import numpy as np
import pytest
from commands import run
from surfaces import ORIGIN, height_field, horizon

from geofit import between, thickness
from geofit.data.errors import GeofitError
from geofit.data.site import Ground
from geofit.io import write_surface
from geofit.io.grid import read_ground
from geofit.project.body_building import BodyResult
from geofit.project.body_export import export_body
from geofit.project.horizon_body import horizon_body
from geofit.sampling.grids import thickness_grid
from geofit.site.order import compare_horizons
from geofit.splines import bspline

#: The area of the horizons, metres.
WIDE, LONG = 1000.0, 700.0


def surface(function, name, outline=None):
    """A bicubic height field through z(x, y), x and y from the south-west corner."""
    patch = height_field(24, 18, size=(WIDE, LONG))
    u, v = (bspline.greville(knots, 3) for knots in (patch.knots_u, patch.knots_v))
    control = patch.control.copy()
    z = np.linalg.solve(bspline.collocation(patch.knots_u, 3, u), function(control[..., 0], control[..., 1]))
    control[..., 2] = np.linalg.solve(bspline.collocation(patch.knots_v, 3, v), z.T).T
    object.__setattr__(patch, "control", control)
    return horizon([patch], name=name, outline=outline)


def layer(thick, function=lambda x, y: 0.0 * x):
    """A layer of even thickness above z(x, y)."""
    return surface(lambda x, y: function(x, y) + thick, "top"), surface(function, "base")


def ground(function, shape=(201, 141)):
    x, y = np.linspace(0.0, WIDE, shape[0]), np.linspace(0.0, LONG, shape[1])
    return Ground(ORIGIN[0] + x, ORIGIN[1] + y, ORIGIN[2] + function(*np.meshgrid(x, y)))


def dome(x, y):
    """A paraboloid, 10 m high in the middle and below zero from 141 m on."""
    return 10.0 - 5e-4 * ((x - 500.0) ** 2 + (y - 350.0) ** 2)


def half_known(x, y):
    """A ground at zero, which is not known in the eastern half."""
    return np.where(x <= 500.0, 0.0, np.nan) + 0.0 * y


def volumes(upper, lower, over=None):
    """Return what the order, the grid and the body state."""
    grid = thickness_grid(upper, lower, 5.0, over)
    weight = np.ones_like(grid.z)
    weight[[0, -1]] /= 2
    weight[:, [0, -1]] /= 2
    body = horizon_body("top", "base", "layer", {"top": upper, "base": lower}, over)
    assert body.overview.is_closed
    assert body.overview.areas.min() > 0
    whole = float(np.nansum(np.maximum(grid.z, 0.0) * weight)) * 25.0
    return compare_horizons(upper, lower, over).volume, whole, body.overview.volume


WALL = WIDE * LONG
FAR_GROUND = Ground(
    ORIGIN[0] + np.array([-200.0, -100.0]), ORIGIN[1] + np.array([0.0, LONG]), np.full((2, 2), ORIGIN[2])
)


@pytest.mark.parametrize(
    ("surfaces", "over", "truth"),
    [
        (layer(10.0), None, 10 * WALL),
        # Thinner than any cell of a body's lattice.
        (layer(0.5), None, 0.5 * WALL),
        (layer(2.0, lambda x, y: 0.4 * x - 0.2 * y), None, 2 * WALL),
        # It thins out to nothing in the middle.
        ((layer(0.0)[0], surface(lambda x, y: (x - 500) / 50, "base")), None, 0.5 * 500 * 10 * LONG),
        # A valley whose floor is 5 m below the base: nothing within 50 m of its axis, whole beyond 150 m.
        (layer(10.0), ground(lambda x, y: 0.1 * np.abs(x - 500) - 5.0), (350 * 10 + 100 * 5) * 2 * LONG),
        # A flat ground cuts a layer of 4 m over a dome: its cap is the part of the upper paraboloid above zero, less
        # that of the lower one; what is below the ground is the rest.
        (layer(4.0, dome), ground(lambda x, y: 0.0 * x), 4 * WALL - np.pi / 2 / 5e-4 * (14**2 - 10**2)),
        (layer(10.0), ground(lambda x, y: 0.0 * x + 50.0), 10 * WALL),
        (layer(10.0), ground(lambda x, y: 0.0 * x + 3.0), 3 * WALL),
        # Beyond the ground's grid nothing is known to be gone.
        (layer(10.0), FAR_GROUND, 10 * WALL),
    ],
)  # fmt: skip
def test_order_grid_and_body_state_the_true_volume(surfaces, over, truth):
    assert volumes(*surfaces, over) == pytest.approx((truth,) * 3, rel=1e-3)


def test_where_the_ground_is_not_known_the_layer_goes_on():
    upper, lower = layer(10.0, lambda x, y: 0.0 * x - 4.0)
    over = ground(half_known)
    # 4 m below the ground in the west, 10 m in the east; between two nodes the ground is not known.
    assert volumes(upper, lower, over) == pytest.approx(((4 + 10) * WALL / 2,) * 3, rel=6e-3)
    x, y = ORIGIN[0] + np.array([100.0, 900.0]), ORIGIN[1] + 350.0
    assert thickness(upper, lower, x, y, over).tolist() == pytest.approx([4.0, 10.0])
    assert thickness(upper, lower, x, y).tolist() == pytest.approx([10.0, 10.0])


def test_a_body_ends_upright_at_the_outline_of_its_horizons():
    corners = np.array([(100.0, 50.0), (900.0, 150.0), (800.0, 650.0), (200.0, 600.0)])
    lower = surface(lambda x, y: 0.0 * x, "base", corners)
    upper = layer(1.0)[0]
    body = horizon_body("top", "base", "layer", {"top": upper, "base": lower})
    assert body.overview.is_closed
    area = compare_horizons(upper, lower).area
    assert body.overview.volume == pytest.approx(area, rel=1e-4)
    rim = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).sum()
    assert body.overview.area == pytest.approx(2 * area + rim, rel=1e-4)


def test_a_body_states_what_lies_above_the_ground():
    surfaces = dict(zip(("top", "base"), layer(10.0), strict=True))
    cut = horizon_body("top", "base", "layer", surfaces, ground(lambda x, y: 0.0 * x + 4.0))
    (note,) = cut.notes
    assert note.code == "project.body-ends-at-ground"
    assert note.params["volume"] == pytest.approx(6 * WALL)
    deep = horizon_body("top", "base", "layer", surfaces, ground(lambda x, y: 0.0 * x + 40.0))
    assert deep.notes == ()
    assert deep.digest != cut.digest
    with pytest.raises(GeofitError) as refusal:
        horizon_body("top", "base", "layer", surfaces, ground(lambda x, y: 0.0 * x - 5.0))
    assert refusal.value.code == "morphing.no-thickness-below-ground"


def test_a_grid_that_is_written_ends_at_the_ground(tmp_path):
    surfaces = dict(zip(("top", "base"), layer(10.0), strict=True))
    over = ground(lambda x, y: 0.0 * x + 4.0)
    (file,) = write_surface(surfaces, tmp_path / "t.asc", value="thickness", cell=50.0, ground=over)
    assert read_ground(file).z == pytest.approx(4.0)


def test_the_command_ends_thickness_at_the_ground_of_the_site(tmp_path, monkeypatch, capsys):
    for one in layer(10.0):
        write_surface({one.name: one}, tmp_path / f"{one.name}.step")
    write_surface(surface(lambda x, y: 0.0 * x + 4.0, "ground"), tmp_path / "ground.asc", cell=50.0)
    x, y = ORIGIN[:2]
    (tmp_path / "picks.csv").write_text(f"horizon,x,y,z\ntop,{x},{y},10\nbase,{x},{y},0\n", encoding="utf-8")
    site = '[ground]\nfile = "ground.asc"\n[picks]\nfile = "picks.csv"\n'
    (tmp_path / "site.toml").write_text(site, encoding="utf-8")
    files = [tmp_path / "top.step", tmp_path / "base.step"]
    out = ["--to", "asc", "--value", "thickness", "--cell", "50", "--out", tmp_path / "t.asc"]
    code, _, err = run(monkeypatch, capsys, "export", *files, *out)
    assert (code, "No ground is given" in err) == (0, True)
    assert read_ground(tmp_path / "t.asc").z == pytest.approx(10.0)
    code, _, err = run(monkeypatch, capsys, "export", *files, *out, "--points", tmp_path / "site.toml")
    assert (code, "No ground is given" in err) == (0, False)
    assert read_ground(tmp_path / "t.asc").z == pytest.approx(4.0)


def test_the_step_file_of_a_thin_layer_has_its_volume(tmp_path):
    """A tenth of a metre over a kilometre: the file is compared with the triangles, not with a field on a lattice."""
    body = horizon_body("top", "base", "layer", dict(zip(("top", "base"), layer(0.1), strict=True)))
    found = export_body(BodyResult(body), "layer", tmp_path / "a.step", progress=lambda *_: True).read_back
    assert found.passed
    by = {check.name: check for check in found.checks}
    assert by["deviation"].value < 1e-6
    assert by["volume"].value < 1e-6 * 0.1 * WALL


def test_the_field_of_a_body_ends_at_the_ground():
    body = between(*layer(10.0), ground=ground(lambda x, y: 0.1 * np.abs(x - 500) - 5.0))
    places = ORIGIN + np.array([(600.0, 350.0, 4.0), (600.0, 350.0, 6.0), (900.0, 350.0, 9.0), (500.0, 350.0, 1.0)])
    assert (body.value(places - body.origin) < 0).tolist() == [True, False, True, False]
