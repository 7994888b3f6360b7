"""Horizons built from lithology through the window: codes grouped, picks shown at once, one step that can be undone."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest
from panel_samples import SITE

from geofit.gui.dialogs.horizon_builder import HorizonBuilder
from geofit.io.site_file import read_site
from geofit.project.horizon_builder import codes_of, picks_of

DATA = Path(os.environ.get("GEOFIT_DATA", Path(__file__).parents[3] / "shared" / "data"))


@pytest.fixture
def opened(app, tmp_path):
    shutil.copytree(SITE.parent, tmp_path / "dam")
    file = tmp_path / "dam" / "site.toml"
    app.desktop.session.begin(read_site(file), file)
    app.idle()
    return app


def drive(monkeypatch, act):
    def run(dialog):
        dialog.show()
        act(dialog.form)
        dialog.done(0)

    monkeypatch.setattr(HorizonBuilder, "exec", run)


def test_codes_are_grouped_the_picks_shown_and_the_horizon_added(opened, monkeypatch):
    document, layers = opened.document, opened.window.panels.view.layers
    before = document.state
    first, second = (code.code for code in codes_of(document.read)[:2])
    seen = []

    def act(dialog):
        assert not dialog.add.isEnabled()
        dialog.check(first)
        alone = dialog.words.text()
        dialog.check(first, second)
        assert dialog.words.text() != alone
        assert dialog.name.text() == f"base of {first} + {second}"
        seen.append(len(dialog.picks.points))
        assert any(layer.horizon == "Preview" for layer in layers)
        dialog.thinner.setValue(5.0)
        seen.append(len(dialog.picks.points))
        dialog.name.setText("T2-T1")
        dialog.name.textEdited.emit(dialog.name.text())
        assert not dialog.add.isEnabled(), "the name is taken"
        dialog.name.setText("overburden")
        dialog.name.textEdited.emit(dialog.name.text())
        dialog.add.click()

    drive(monkeypatch, act)
    opened.trigger("build_horizon")
    opened.idle()
    assert not any(layer.horizon == "Preview" for layer in layers)
    assert "overburden" in document.horizons
    assert not opened.window.panels.changes.isVisible(), "a new horizon has not moved"
    assert len(document.site.horizons["overburden"]) == seen[1]
    assert set(before.order) < set(document.horizons)
    opened.window.fitting.fit("overburden")
    opened.idle()
    assert document.surface("overburden") is not None
    for _ in range(2):
        opened.window.menus.undo.trigger()
        opened.idle()
    assert document.state == before


def test_a_site_without_tables_of_horizons_keeps_those_it_has(app, tmp_path, monkeypatch):
    (tmp_path / "c.csv").write_text("hole,x,y,z,depth\n" + "".join(f"B{k},{k},{k * k},100,30\n" for k in range(5)))
    log = "".join(f"B{k},0,{5 + k},soil\nB{k},{5 + k},30,rock\n" for k in range(5))
    (tmp_path / "l.csv").write_text("hole,from,to,code\n" + log)
    (tmp_path / "p.csv").write_text("x,y,z,horizon\n" + "".join(f"{k},{k % 3},5,water\n" for k in range(9)))
    (tmp_path / "site.toml").write_text(
        '[boreholes]\ncollar = "c.csv"\nintervals = ["l.csv"]\n[[picks]]\nfile = "p.csv"\n'
    )
    app.desktop.session.begin(read_site(tmp_path / "site.toml"), tmp_path / "site.toml")
    app.idle()
    assert app.document.horizons == ("water",)

    def act(dialog):
        dialog.check("soil")
        dialog.add.click()
        dialog.check("rock")
        dialog.limit.setCurrentIndex(1)
        dialog.add.click()

    drive(monkeypatch, act)
    app.trigger("build_horizon")
    app.idle()
    assert set(app.document.horizons) == {"water", "base of soil", "top of rock"}


def test_the_new_horizon_stands_by_its_elevation_and_is_moved_up_and_down(opened, monkeypatch):
    document = opened.document
    before, code = document.state, codes_of(document.read)[0].code
    levels = {name: points.xyz[:, 2].mean() for name, points in document.read.horizons.items()}
    wanted = []

    def act(dialog):
        place = dialog.place
        assert place.order == before.order
        assert not place.up.isEnabled()
        assert not place.down.isEnabled()
        dialog.check(code)
        name, level = dialog.name.text(), dialog.picks.points.xyz[:, 2].mean()
        at = place.order.index(name)
        assert all(levels[other] >= level for other in place.order[:at])
        assert at == len(before.order) or levels[place.order[at + 1]] < level
        assert place.list.item(at).font().bold()
        while place.up.isEnabled():
            place.up.click()
        assert place.order == (name, *before.order)
        place.down.click()
        dialog.thinner.setValue(0.2)
        dialog.name.setText("first")
        dialog.name.textEdited.emit("first")
        assert place.order == (before.order[0], "first", *before.order[1:])
        dialog.add.click()
        dialog.check(code)
        dialog.limit.setCurrentIndex(1)
        while place.down.isEnabled():
            place.down.click()
        wanted.append(place.order)
        dialog.add.click()

    drive(monkeypatch, act)
    opened.trigger("build_horizon")
    opened.idle()
    assert document.horizons == wanted[0]
    assert document.horizons[1] == "first"
    rows = next(head.rows for head in opened.window.panels.tree.items.rows if head.target == ("group", "horizons"))
    assert tuple(row.target[1] for row in rows) == wanted[0]
    for _ in range(2):
        opened.window.menus.undo.trigger()
        opened.idle()
    assert document.state == before


@pytest.mark.skipif(not (DATA / "copper_creek").is_dir(), reason="the data of Copper Creek are not here")
def test_copper_creek_groups_thousands_of_intervals(tmp_path):
    from geofit.project.importing import import_files

    files = sorted((DATA / "copper_creek").glob("*.csv"))
    site = import_files(files, tmp_path / "site.toml").site
    codes = codes_of(site)
    assert len(codes) > 5
    from geofit.io.contact_rules import ContactRule

    common = sorted(codes, key=lambda one: -one.holes)[:3]
    group = ContactRule(tuple(one.code for one in common), "base")
    picks = picks_of(site, group)
    thick = picks_of(site, ContactRule(group.codes, "base", None, 5.0))
    first = picks_of(site, ContactRule(group.codes, "base", "first"))
    assert 0 < len(thick.points) <= picks.carrying
    assert len(picks.points) + picks.unseen == picks.carrying
    assert first.points.xyz[:, 2].mean() > picks.points.xyz[:, 2].mean()
