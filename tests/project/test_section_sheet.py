"""Bodies on a printed section sheet: outline and band where they belong, in the legend, and in every format."""

from __future__ import annotations

from dataclasses import replace

import ezdxf
import numpy as np
import pytest

import geofit
from geofit.bodies.section import chance_lines, outline_rings
from geofit.data.languages import language
from geofit.data.site import Hole, Site
from geofit.implicit.mesh import TriangleMesh
from geofit.project.section_sheet import SheetBody, SheetOrder, write_section_sheet
from geofit.report.paper import SheetTitle
from geofit.report.section_pages import write_sheet_svg
from geofit.site.section_view import BodyTrace, section_view

PLACE = np.array([500_000.0, 3_100_000.0, 800.0])
RADIUS = 40.0
THROUGH = PLACE[:2] + np.array([[-200.0, -150.0], [200.0, 150.0]])
BESIDE = THROUGH + np.array([300.0, -300.0])


@pytest.fixture(scope="module")
def ball():
    rng = np.random.default_rng(2)
    unit = rng.normal(size=(40, 3))
    unit /= np.linalg.norm(unit, axis=1)[:, None]
    around = PLACE + 1.7 * RADIUS * np.vstack([np.eye(3), -np.eye(3)])
    return geofit.fit_body(geofit.BodyData(PLACE + RADIUS * unit, [PLACE], around), name="ball")


@pytest.fixture(scope="module")
def mesh(ball):
    return TriangleMesh(ball.overview.vertices + ball.origin, ball.overview.triangles)


def area(ring):
    x, y = ring.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


def test_the_outline_on_a_section_is_that_of_the_body(mesh):
    (ring,) = outline_rings(mesh, THROUGH)
    assert area(ring) == pytest.approx(np.pi * RADIUS**2, rel=0.03)
    assert ring.mean(axis=0) == pytest.approx([250.0, PLACE[2]], abs=2.0)
    assert outline_rings(mesh, BESIDE) == ()


def test_a_hole_in_the_body_runs_clockwise():
    angle = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    u, v = (a.ravel() for a in np.meshgrid(np.arange(48), np.arange(24), indexing="ij"))
    tube = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    across = 30 + 10 * np.cos(tube[v])
    xyz = np.column_stack([across * np.cos(angle[u]), 10 * np.sin(tube[v]), across * np.sin(angle[u])])
    of = lambda a, b: (a % 48) * 24 + b % 24  # noqa: E731
    faces = [(of(a, b), of(a + 1, b), of(a + 1, b + 1)) for a in range(48) for b in range(24)]
    faces += [(of(a, b), of(a + 1, b + 1), of(a, b + 1)) for a in range(48) for b in range(24)]
    rings = outline_rings(TriangleMesh(xyz, np.array(faces)), [[-60.0, 0.01], [60.0, 0.01]])
    assert sorted(np.sign([area(one) for one in rings])) == [-1, 1]
    assert sum(area(one) for one in rings) == pytest.approx(np.pi * (40**2 - 20**2), rel=0.02)


def test_the_band_lies_where_the_chance_is_a_tenth_and_nine(ball):
    from geofit.bodies.posterior import BodyPosterior

    lines = chance_lines(ball, THROUGH)
    posterior, way = BodyPosterior(ball), (THROUGH[1] - THROUGH[0]) / 500.0
    sides = []
    for line in lines:
        places = np.column_stack([THROUGH[0] + line[:, :1] * way, line[:, 1]])
        value, deviation = ball.value(places), posterior.deviation(places)
        # Contours of a raster with steps of a metre.
        assert np.median(np.abs(posterior.margin(places, 0.1 if np.median(value) > 0 else 0.9))) < 0.01
        sides.append(np.median(value) > 0)
        close = posterior.open_ground(places) & (np.abs(posterior.margin(places, 0.1)) < 1e-3 * deviation)
        assert posterior.probability(places[close]) == pytest.approx(0.1, abs=0.01)
    assert set(sides) == {True, False}


def test_every_format_has_the_body(ball, mesh, tmp_path):
    site = Site("trial", {})
    order = SheetOrder(
        {"A": THROUGH, "B": BESIDE}, 30.0, SheetTitle("Section"), tmp_path / "sheet", ("svg", "dxf", "pdf")
    )
    bodies = {"ball": SheetBody(mesh, "#b3572f", ball), "shell": SheetBody(mesh, "#3f7f9f")}
    _, files = write_section_sheet(site, {}, {}, order, bodies)
    assert all(file.stat().st_size > 1000 for file in files)
    space = ezdxf.readfile(tmp_path / "sheet.dxf").modelspace()
    layers = [entity.dxf.layer for entity in space]
    assert layers.count("BODY_ball") == 1
    assert layers.count("BODY_ball_band") == len(chance_lines(ball, THROUGH))
    assert layers.count("BODY_shell") == 1
    assert "BODY_shell_band" not in layers
    (outline,) = space.query('LWPOLYLINE[layer=="BODY_ball"]')
    low = min(y for _, y in outline.get_points("xy"))
    (corner,) = space.query('LWPOLYLINE[layer=="FRAME"]')[:1]
    assert low >= min(y for _, y in corner.get_points("xy"))


def two_horizons():
    """A site with two horizons and a hole at the highest place of its section, and the lower horizon's surface."""
    x, y = np.meshgrid(np.linspace(-150, 150, 7), np.linspace(-150, 150, 7))
    at = {"top": -20.0, "base": -60.0}
    points = {
        name: geofit.PointSet(np.column_stack([x.ravel(), y.ravel(), z + 0.05 * x.ravel()]) + PLACE)
        for name, z in at.items()
    }
    hole = Hole("ZK-with-a-name", "borehole", np.array([0.0, 100.0]), np.array([[0.0, 0, 0], [0, 0, -100]]) + PLACE)
    return Site("trial", points, holes=(hole,)), {"base": geofit.fit_horizon(points["base"], name="base")}


def legend_of(monkeypatch):
    """Return the list that the labels of each legend are added to."""
    from matplotlib.figure import Figure

    found, plain = [], Figure.legend

    def legend(self, handles, labels, **options):
        found.extend(labels)
        return plain(self, handles, labels, **options)

    monkeypatch.setattr(Figure, "legend", legend)
    return found


def test_points_are_those_of_the_horizons_on_the_sheet(tmp_path, monkeypatch):
    site, surfaces = two_horizons()
    labels = legend_of(monkeypatch)
    for shown, layers, named in (
        (surfaces, {"base_points"}, []),
        ({}, {"top_points", "base_points"}, ["points of top", "points of base"]),
    ):
        labels.clear()
        order = SheetOrder({"A": THROUGH}, 60.0, SheetTitle("Section"), tmp_path / "sheet", ("svg", "dxf"))
        write_section_sheet(site, shown, {}, order)
        document = ezdxf.readfile(tmp_path / "sheet.dxf")
        assert {one.dxf.layer for one in document.modelspace().query("POINT")} == layers
        assert {layer.dxf.name for layer in document.layers if layer.dxf.name.endswith("_points")} == layers
        assert [label for label in labels if label.startswith("points")] == named


def test_names_of_holes_do_not_cross_the_edge_of_the_drawing(tmp_path):
    from geofit.report.section_pages import sheet_page

    site, surfaces = two_horizons()
    view = section_view(site, surfaces, THROUGH, 60.0, name="A")
    figure = sheet_page([view], view, 1, SheetTitle("Section"), "A3", 2000, 1.0, language("en"))
    figure.draw_without_rendering()
    (axes,) = (one for one in figure.axes if one.texts and one.lines)
    (name,) = (text for text in axes.texts if text.get_text() == "ZK-with-a-name")
    assert name.get_window_extent().y0 > axes.bbox.y1
    order = SheetOrder({"A": THROUGH}, 60.0, SheetTitle("Section"), tmp_path / "sheet", ("dxf",))
    write_section_sheet(site, surfaces, {}, order)
    space = ezdxf.readfile(tmp_path / "sheet.dxf").modelspace()
    (frame,) = space.query('LWPOLYLINE[layer=="FRAME"]')
    (written,) = (text for text in space.query("TEXT") if text.dxf.text == "ZK-with-a-name")
    assert written.dxf.insert.y > max(y for _, y in frame.get_points("xy"))


@pytest.mark.parametrize(("code", "words"), [("en", ("body ball", "80 % chance")), ("zh", ("地质体 ball", "80 %"))])
def test_the_legend_names_body_and_band(code, words, tmp_path, monkeypatch):
    found = legend_of(monkeypatch)
    ring = np.array([[100.0, 0], [150, 0], [150, 30], [100, 30]])
    view = section_view(Site("trial", {}), {}, THROUGH, 30.0, name="A")
    view = replace(view, bodies=(BodyTrace("ball", "#b3572f", (ring,), (ring + 3,)),))
    write_sheet_svg([view], SheetTitle("Section"), tmp_path / "a.svg", language=language(code))
    assert all(any(word in label for label in found) for word in words), found
    assert view.levels == (0.0, 33.0)
