"""Bodies in the window from outlines on sections, picked points and meshes; a site that has bodies alone."""

from __future__ import annotations

import json
import shutil

import ezdxf
import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFileDialog

from geofit.implicit import Sphere
from geofit.implicit.isosurface import isosurface
from geofit.implicit.lattice import Lattice
from geofit.project.body_record import Intervals, Outlines, SurfacePicks

PLACE = np.array([1400.0, 2600.0, 500.0])
#: A place within the sample site, map coordinates.
SITE = np.array([500900.0, 3100900.0, 1450.0])
ANGLE = np.linspace(0, 2 * np.pi, 40, endpoint=False)


def rings():
    """Ellipses across a lens on five sections, and a second lens on the last two."""
    for k, x in enumerate((-40.0, -20.0, 0.0, 20.0, 40.0)):
        width = 30.0 * np.sqrt(1 - (x / 60) ** 2)
        lens = np.column_stack([np.full(40, x), width * np.cos(ANGLE), 0.4 * width * np.sin(ANGLE)])
        yield f"S{k}", PLACE + lens
        if x > 0:
            yield f"S{k}", PLACE + 0.5 * lens + [0.5 * x, 70.0, 0.0]


@pytest.fixture
def opened(app, sample):
    app.window.files.open(sample / "site.toml")
    app.idle()
    app.panels, app.bodies = app.window.panels, app.window.bodies
    app.panels.reveal("bodies")
    app.sample = sample
    return app


def choose(app, monkeypatch, kind, file):
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(file), ""))
    box = app.panels.bodies.source.kind
    box.setCurrentIndex(box.findData(kind))
    box.activated.emit(box.currentIndex())
    app.idle()


def fit(app):
    app.qtbot.mouseClick(app.panels.bodies.fit_button, Qt.MouseButton.LeftButton)
    app.idle()


def drawing(path):
    document = ezdxf.new("R2010")
    for layer, ring in rings():
        document.modelspace().add_polyline3d(ring, close=True, dxfattribs={"layer": layer})
    document.modelspace().add_polyline3d(PLACE + 500 * np.eye(3), close=True, dxfattribs={"layer": "FRAME"})
    document.saveas(path)
    return path


def test_outlines_of_a_drawing_become_a_body_with_questions(opened, monkeypatch):
    file = drawing(opened.sample / "lens.dxf")
    choose(opened, monkeypatch, "outlines", file)
    panel = opened.panels.bodies
    codes = panel.source.codes
    offered = {codes.item(i).text(): codes.item(i) for i in range(codes.count())}
    assert list(offered) == ["S0  (1)", "S1  (1)", "S2  (1)", "S3  (2)", "S4  (2)", "FRAME  (1)"]
    assert all(item.checkState() == Qt.CheckState.Checked for item in offered.values())
    offered["FRAME  (1)"].setCheckState(Qt.CheckState.Unchecked)
    fit(opened)
    record = opened.document.state.bodies["lens"]
    assert record.provenance.source == Outlines("lens.dxf", ("S0", "S1", "S2", "S3", "S4"))
    result = opened.document.body("lens")
    assert result.accuracy.verdict == "PASS"
    assert [(one.code, one.first, one.second, one.parts) for one in result.questions] == [
        ("branches", "S2", "S3", (1, 2))
    ]
    figures = opened.panels.body_figures
    assert "Questions between sections: 1" in figures.count.text()
    assert figures.violations.rows.index(0, 0).data() == "Question"
    figures.violations.chosen.emit(0)
    assert panel.badge.isVisibleTo(panel)


def test_flat_drawings_of_the_site_file_become_a_body(opened, monkeypatch):
    """Each section is drawn flat, in units and about an origin of its own."""
    text = (opened.sample / "site.toml").read_text(encoding="utf-8")
    for k, x in enumerate((-40.0, -20.0, 0.0, 20.0, 40.0)):
        width = 30.0 * np.sqrt(1 - (x / 60) ** 2)
        uv = np.column_stack([100 + width * np.cos(ANGLE), PLACE[2] + 0.4 * width * np.sin(ANGLE)])
        document = ezdxf.new("R2010")
        document.modelspace().add_lwpolyline((4 * uv + [k, 9]).tolist(), close=True, dxfattribs={"layer": "LENS"})
        document.saveas(opened.sample / f"flat{k}.dxf")
        line = [[1400.0 + x, 2500.0], [1400.0 + x, 2700.0]]
        text += f'\n[[section]]\nname = "F{k}"\nline = {line}\nfile = "flat{k}.dxf"\nscale = 4\norigin = [{k}, 9]\n'
    (opened.sample / "flat.toml").write_text(text, encoding="utf-8")
    choose(opened, monkeypatch, "outlines", opened.sample / "flat.toml")
    fit(opened)
    (found,) = (
        opened.document.body(name)
        for name, one in opened.document.state.bodies.items()
        if one.provenance.source == Outlines("flat.toml")
    )
    assert found.accuracy.verdict == "PASS"
    lower, upper = found.mesh.vertices.min(axis=0), found.mesh.vertices.max(axis=0)
    np.testing.assert_allclose((lower + upper) / 2 + found.body.origin, PLACE, atol=3.0)


def test_the_same_outlines_as_geojson(opened, monkeypatch):
    features = [
        {"type": "Feature", "properties": {"section": name},
         "geometry": {"type": "Polygon", "coordinates": [[*ring.tolist(), ring[0].tolist()]]}}
        for name, ring in rings()
    ]  # fmt: skip
    file = opened.sample / "lens.geojson"
    file.write_text(json.dumps({"type": "FeatureCollection", "features": features}), encoding="utf-8")
    choose(opened, monkeypatch, "outlines", file)
    fit(opened)
    assert opened.document.state.bodies["lens"].provenance.source == Outlines("lens.geojson")
    assert opened.document.body("lens").accuracy.passed


def test_points_with_and_without_normals_become_a_body(opened, monkeypatch):
    rng = np.random.default_rng(5)
    unit = rng.normal(size=(120, 3))
    unit /= np.linalg.norm(unit, axis=1)[:, None]
    rows = ["x,y,z,nx,ny,nz"]
    for k, (place, n) in enumerate(zip(PLACE + 25 * unit, unit, strict=True)):
        rows.append(",".join(f"{c:.4f}" for c in place) + ("," + ",".join(f"{c:.4f}" for c in n) if k % 2 else ",,,"))
    file = opened.sample / "ball.csv"
    file.write_text("\n".join(rows) + "\n", encoding="utf-8")
    choose(opened, monkeypatch, "points", file)
    assert not opened.panels.bodies.source.codes.isVisibleTo(opened.panels.bodies)
    fit(opened)
    assert opened.document.state.bodies["ball"].provenance.source == SurfacePicks("ball.csv")
    assert opened.document.body("ball").mesh.volume == pytest.approx(4 / 3 * np.pi * 25**3, rel=0.02)


def test_a_file_without_outlines_is_refused_and_another_can_be_chosen(opened, monkeypatch):
    document = ezdxf.new("R2010")
    document.modelspace().add_line((0, 0), (1, 1))
    empty = opened.sample / "empty.dxf"
    document.saveas(empty)
    with pytest.raises(AssertionError, match="0 planes"):
        choose(opened, monkeypatch, "outlines", empty)
    opened.failures.clear()
    panel = opened.panels.bodies
    assert not panel.fit_button.isEnabled()
    assert "Choose the file" in panel.banner.text
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(drawing(opened.sample / "lens.dxf")), ""))
    opened.qtbot.mouseClick(panel.source.browse, Qt.MouseButton.LeftButton)
    opened.idle()
    assert panel.fit_button.isEnabled()


@pytest.fixture
def bodies_alone(app, sample, tmp_path):
    """The sample's site of bodies, copied and opened."""
    for name in ("bodies.toml", "bodies"):
        source = sample / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, tmp_path / name)
    app.window.files.open(tmp_path / "bodies.toml")
    app.idle()


def test_a_site_of_bodies_alone(app, bodies_alone, tmp_path, once):
    document, panels = app.document, app.window.panels
    assert document.is_open
    assert not document.horizons
    assert panels.bodies.source.codes.count() >= 3
    assert app.window.actions_["save"].isEnabled()
    assert not app.window.actions_["fit"].isEnabled()
    with once("fit ORE alone"):
        app.window.bodies.fit("", Intervals(("ORE",)), panels.bodies.form.edited())
        app.idle()
    assert document.body("ORE").accuracy.passed
    app.window.files.save_to(tmp_path / "work.geofit")
    app.idle()
    app.window.files.open(tmp_path / "work.geofit")
    app.idle()
    assert list(document.state.bodies) == ["ORE"]
    assert document.body("ORE").origin == "again"
    app.window.grab().save(str(tmp_path / "alone.png"))


def test_the_files_of_a_site_of_bodies_alone_are_read_again(app, bodies_alone, tmp_path, once):
    with once("fit ORE alone"):
        app.window.bodies.fit("", Intervals(("ORE",)), app.window.panels.bodies.form.edited())
        app.idle()
    log = tmp_path / "bodies" / "lithology.csv"
    rows = log.read_text(encoding="utf-8").splitlines(keepends=True)
    ore = next(k for k, row in enumerate(rows) if "ORE" in row)
    log.write_text("".join(rows[:ore] + rows[ore + 1 :]), encoding="utf-8")
    before = app.document.read
    app.window.living.reload()
    app.idle()
    assert app.failures == []
    assert app.document.read is not before
    assert not app.document.horizons
    assert app.window.bodies.showing.stale("ORE"), "its log has changed"
    app.desktop.session.stack.undo()
    assert not app.window.bodies.showing.stale("ORE")
    app.desktop.session.stack.redo()
    app.window.files.save_to(tmp_path / "work.geofit")
    app.idle()
    app.window.files.open(tmp_path / "work.geofit")
    app.idle()
    assert app.window.bodies.showing.stale("ORE"), "it was made from the log as it was"
    assert app.failures == []


def test_a_mesh_in_other_units_is_not_drawn_and_one_inside_out_is_turned_with_a_warning(opened, tmp_path):
    ball = isosurface(Sphere([0, 0, 0], 30.0), Lattice.around([-36] * 3, [36] * 3, cells=30), capped=True)
    for name, scale, turn in (("millimetres", 1000.0, 1), ("inward", 1.0, -1)):
        rows = [f"v {x} {y} {z}" for x, y, z in (scale * (ball.vertices + SITE)).tolist()]
        rows += [f"f {a} {b} {c}" for a, b, c in (ball.triangles[:, ::turn] + 1).tolist()]
        (tmp_path / f"{name}.obj").write_text("\n".join(rows) + "\n", encoding="utf-8")
        opened.bodies.take_mesh(tmp_path / f"{name}.obj")
        opened.idle()
        said = opened.panels.bodies.warning
        assert said.isVisibleTo(opened.panels.bodies)
        assert ("it is not drawn" in said.text) == (turn == 1)
        assert ("point inwards" in said.text) == (turn == -1)
        assert (f"body:{name}" in opened.panels.view.layers) == (turn == -1)
        assert opened.document.body(name).volume == pytest.approx(scale**3 * ball.volume)
