"""Triangles for a view: fine where one looks, coarse elsewhere, without cracks, and no more than are needed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from surfaces import ORIGIN, fold, horizon, nine
from vtkmodules.vtkRenderingCore import vtkCamera

from geofit.gui.view3d.camera import Viewpoint
from geofit.gui.view3d.drawn import drawn_of
from geofit.gui.view3d.projector import Projector
from geofit.gui.view3d.shape import MOST, shape_of, too_coarse
from geofit.gui.view3d.sight import PIXELS, Sight

WIDTH, HEIGHT = 900.0, 600.0
OUTLINE = np.array([[100, 80], [500, -20], [900, 100], [950, 600], [500, 400], [80, 650]], float)
SURFACES = {
    "nine patches": lambda: horizon(nine()[1]),
    "outline": lambda: horizon(nine()[1], outline=OUTLINE),
    "overturned fold": lambda: horizon([fold()]),
}
VIEWS = {
    "whole": (700.0, 32.0, False),
    "near": (60.0, 40.0, False),
    "along": (90.0, 8.0, False),
    "map": (30.0, 90.0, True),
}


def sight_of(surface, view, stretch=1.0, at=0.5):
    """Look at a vertex of the surface, the share ``at`` of them before it."""
    distance, height, parallel = VIEWS[view]
    xyz = surface.triangulate(5.0).xyz
    origin = np.round(xyz.mean(axis=0))
    centre = (xyz[int(at * (len(xyz) - 1))] - origin) * (1.0, 1.0, stretch)
    viewpoint = Viewpoint(centre, 212.0, height, distance, parallel)
    camera = vtkCamera()
    viewpoint.put(camera)
    camera.SetClippingRange(0.01 * distance, 100 * distance)
    matrix = camera.GetCompositeProjectionTransformMatrix(WIDTH / HEIGHT, -1, 1)
    values = np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])
    return Sight(Projector(values, WIDTH, HEIGHT, origin, stretch), 0.1 * distance)


def apart(surface, sight, shape, seed=0):
    """Return how many pixels places on the triangles in sight are drawn from their feet on the surface."""
    rng = np.random.default_rng(seed)
    corners = shape.xyz[shape.triangles]
    screen = sight.view.screen(corners.reshape(-1, 3)).reshape(-1, 3, 3)
    inside = ((screen[..., :2] > 0) & (screen[..., :2] < (WIDTH, HEIGHT))).all(axis=2).any(axis=1)
    inside &= (screen[..., 2] > 0).all(axis=1)
    corners = corners[inside][rng.integers(inside.sum(), size=1_500)]
    places = np.einsum("nk,nkd->nd", rng.dirichlet([1, 1, 1], len(corners)), corners)
    depth = (places - sight.view.origin) * (1, 1, sight.view.stretch) @ sight.view.matrix[3, :3] + sight.view.matrix[
        3, 3
    ]
    places = places[depth >= sight.nearest] if sight.view.matrix[3, :3].any() else places
    feet = surface.project(places).foot + surface.origin
    return np.linalg.norm((sight.view.screen(places) - sight.view.screen(feet))[:, :2], axis=1)


@pytest.mark.parametrize("stretch", [1.0, 4.0])
@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("name", SURFACES)
def test_triangles_in_sight_are_within_half_a_pixel_of_the_surface(name, view, stretch):
    surface = SURFACES[name]()
    sight = sight_of(surface, view, stretch)
    error = apart(surface, sight, shape_of(surface, sight))
    assert len(error) > 500
    assert error.max() <= PIXELS


@pytest.mark.parametrize("at", [0.1, 0.37, 0.5, 0.92])
@pytest.mark.parametrize("view", ["near", "along"])
@pytest.mark.parametrize("name", SURFACES)
def test_there_are_no_cracks_between_fine_and_coarse(name, view, at):
    """Neighbours have the very same vertices: every edge has two triangles, or lies on the rim."""
    surface = SURFACES[name]()
    mesh = surface.triangulate(lambda low, high: sight_of(surface, view, at=at).tolerance(low, high, 1.0))
    t = mesh.triangles
    pairs = np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1)
    edges, count = np.unique(pairs, axis=0, return_counts=True)
    assert count.max() == 2
    a, b = (mesh.points[edges[count == 1][:, k]] for k in (0, 1))
    whole = surface.triangulate(0.01)
    u = whole.triangles
    rims = np.sort(np.concatenate([u[:, [0, 1]], u[:, [1, 2]], u[:, [2, 0]]]), axis=1)
    rim, once = np.unique(rims, axis=0, return_counts=True)
    c, d = (whole.points[rim[once == 1][:, k]] for k in (0, 1))
    # The rim is as long as that of the same surface with one tolerance for all: a crack would add to it.
    lengths = [float(np.linalg.norm(p - q, axis=1).sum()) for p, q in ((a, b), (c, d))]
    assert lengths[0] == pytest.approx(lengths[1], rel=2e-3)


def test_only_what_is_looked_at_is_fine():
    surface = SURFACES["nine patches"]()
    near, base = shape_of(surface, sight_of(surface, "near")), shape_of(surface)
    finest = float(np.min(sight_of(surface, "near").tolerance(*(np.array([end]) for end in surface.bounds), 1.0)))
    uniform = surface.triangulate(finest)
    assert len(base.triangles) < len(near.triangles) < 0.5 * len(uniform.triangles)
    assert len(near.coarse.triangles) <= 1_000


def test_more_is_asked_for_once_and_only_from_near():
    surface = SURFACES["nine patches"]()
    far, near = sight_of(surface, "whole"), sight_of(surface, "near")
    aside = sight_of(surface, "near", at=0.05)
    assert too_coarse(surface, near, None)
    assert not too_coarse(surface, near, near)
    assert not too_coarse(surface, far, near)
    assert too_coarse(surface, aside, near)
    assert not too_coarse(surface, replace(far, view=replace(far.view, width=90.0, height=60.0)), None)


def test_a_view_from_very_near_keeps_to_the_most_triangles():
    surface = SURFACES["nine patches"]()
    sight = sight_of(surface, "map")
    matrix = sight.view.matrix.copy()
    matrix[:2] *= 1e5
    sight = replace(sight, view=replace(sight.view, matrix=matrix))
    assert len(shape_of(surface, sight).triangles) <= MOST


def test_what_is_drawn_for_a_view_is_drawn_with_its_colours_and_picked(qtbot):
    from panel_samples import item_of

    from geofit.gui.view3d.view import SceneView

    surface = horizon(nine()[1])
    view = SceneView()
    qtbot.addWidget(view)
    view.resize(640, 480)
    view.show()
    qtbot.waitExposed(view)
    view.show_surface(surface)
    view.layers.change(f"surface:{surface.name}", colour_by="elevation", isolines=True)
    qtbot.waitUntil(lambda: view.idle, timeout=5000)
    before = len(item_of(view, f"surface:{surface.name}").shape.triangles)
    place = ORIGIN + np.array([430.0, 320.0, 0.0])
    place[2] = surface.elevation(*place[:2])
    with qtbot.waitSignal(view.sharper_wanted, timeout=5000) as asked:
        view.canvas.look(replace(view.canvas.viewpoint, centre=place - view.canvas.origin, distance=40.0))
        view.canvas.rest()
        view.layers.change(f"surface:{surface.name}", opacity=0.9)
    name, sight = asked.args
    view.sharpen(surface, drawn_of(surface, sight=sight))
    item = item_of(view, f"surface:{name}")
    assert len(item.shape.triangles) > before
    assert {part.detail for part in item.parts} == {"full", "coarse"}
    np.testing.assert_allclose(view.pointer.place_at(*view.canvas.projector().screen(place)[0, :2]), place, atol=0.05)
    with qtbot.assertNotEmitted(view.sharper_wanted, wait=300):
        view.layers.change(f"surface:{surface.name}", opacity=1.0)
    view.close()


def test_another_fit_is_not_covered_by_what_was_made_of_the_old_one(qtbot):
    from geofit.gui.view3d.view import SceneView

    surface, other = horizon(nine()[1]), horizon([fold()])
    view = SceneView()
    qtbot.addWidget(view)
    view.show_surface(other)
    known = view.contents.drawn[other.name]
    assert surface.name == other.name
    view.sharpen(surface, drawn_of(surface))
    assert view.contents.drawn[other.name] is known
    view.close()


def test_the_window_sharpens_a_surface_that_one_comes_near_to(app):
    from panel_samples import SITE, fitted, sample_site

    from geofit.project.commands import SetSurface

    name = "T3-T2"
    app.desktop.session.begin(sample_site(), SITE)
    provenance = app.document.provenance(name)
    app.document.put(provenance, fitted())
    app.window.fitting.push(SetSurface(provenance))
    app.idle()
    view = app.window.panels.view
    before = view.contents.drawn[name]
    place = before.shape.xyz[len(before.shape.xyz) // 2]
    view.canvas.look(replace(view.canvas.viewpoint, centre=place - view.canvas.origin, distance=25.0))
    view.layers.change(f"surface:{name}", opacity=0.9)
    app.qtbot.waitUntil(lambda: view.contents.drawn[name].sight is not None, timeout=20_000)
    app.idle()
    after = view.contents.drawn[name]
    assert len(after.shape.triangles) > len(before.shape.triangles)
    assert len(after.supported[0]) == len(after.shape.triangles)
    assert not app.failures
