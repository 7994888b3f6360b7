"""The import wizard: guesses shown and overruled, nothing read while a role is missing, problems listed."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox

from geofit.gui.wizard.draft import drafts_of, free_name
from geofit.gui.wizard.import_wizard import ImportWizard
from geofit.gui.wizard.memory import Memory
from geofit.gui.wizard.table_page import BAD
from geofit.io.site_file import read_site

SAMPLE = Path(__file__).resolve().parents[2] / "sample_data"

COLLAR = "孔号;坐标X;坐标Y;孔口高程;孔深\n" + "".join(
    f"ZK{i};{500000 + 40 * i},5;{3100000 + i};{900 - i},25;60\n" for i in range(8)
)
LOG = "孔号,起始深度,终止深度,岩性\n" + "".join(f"ZK{i},0,{10 + i},Q\nZK{i},{10 + i},60,T2\n" for i in range(8))


def opened(qtbot, folder, *files):
    wizard = ImportWizard(files, folder)
    qtbot.addWidget(wizard)
    wizard.show()
    rested(qtbot, wizard)
    return wizard


def rested(qtbot, wizard):
    qtbot.waitUntil(lambda: not wizard.running, timeout=30_000)


def press(qtbot, wizard, button):
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
    rested(qtbot, wizard)


def row_of(wizard, name):
    return next(k for k, draft in enumerate(wizard.drafts()) if draft.title == name)


def roles_shown(wizard):
    table = wizard.page.table
    return [table.cellWidget(0, k).currentData() for k in range(table.columnCount())]


def name_column(wizard, column, role):
    box = wizard.page.table.cellWidget(0, column)
    assert isinstance(box, QComboBox)
    box.setCurrentIndex(box.findData(role))
    box.activated.emit(box.currentIndex())


def choose(box, value):
    box.setCurrentIndex(box.findData(value))
    box.activated.emit(box.currentIndex())


def test_the_sample_site_s_files_become_a_site(qtbot, tmp_path):
    for file in SAMPLE.iterdir():
        if file.suffix in (".csv", ".asc"):
            shutil.copy(file, tmp_path)
    wizard = opened(qtbot, tmp_path, *sorted(tmp_path.iterdir()))
    assert wizard.go.isEnabled()
    wizard.list.setCurrentRow(row_of(wizard, "collar.csv"))
    assert roles_shown(wizard) == ["hole", "x", "y", "z", "depth"]
    press(qtbot, wizard, wizard.go)
    assert "rows read = " in wizard.results.balance.text()
    assert wizard.results.horizons.rows.total > 3
    with qtbot.waitSignal(wizard.accepted):
        press(qtbot, wizard, wizard.go)
    site = read_site(wizard.site_file)
    assert len(site.holes) >= 60
    read, used, listed = (sum(getattr(c, key) for c in site.counts) for key in ("read", "used", "listed"))
    assert read == used + listed


def test_chinese_headers_in_gb18030_with_decimal_commas_are_read(qtbot, tmp_path):
    (tmp_path / "钻孔.csv").write_bytes(COLLAR.encode("gb18030"))
    (tmp_path / "地层.csv").write_bytes(LOG.encode("gb18030"))
    wizard = opened(qtbot, tmp_path, tmp_path / "钻孔.csv", tmp_path / "地层.csv")
    draft = wizard.drafts()[0]
    assert (draft.kind, draft.preview.sep, draft.preview.decimal) == ("collar", ";", ",")
    assert draft.preview.encoding.startswith("gb")
    press(qtbot, wizard, wizard.go)
    assert "base of Q" in wizard.results.horizons.rows.columns[0].values


def test_encodings_have_the_names_that_editors_give_them(qtbot, tmp_path):
    (tmp_path / "collar.csv").write_text(COLLAR, encoding="utf-8-sig")
    page = opened(qtbot, tmp_path, tmp_path / "collar.csv").page
    assert page.encoding.currentText() == "UTF-8 (BOM)"
    assert page.encoding.currentData() == "utf-8-sig"
    assert page.unit.currentText() == "metres (not stated)"


def test_problems_are_counted_and_files_of_other_folders_named_without_them(qtbot, tmp_path):
    data, site = tmp_path / "data", tmp_path / "a" / "b"
    data.mkdir()
    site.mkdir(parents=True)
    (data / "collar.csv").write_text("hole,east,north,elevation\nA,1,2,3\nB,4,5,6\nC,7,9,8\n")
    log = "hole,from,to,code\nA,0,5,Q\nA,5,9,T\nB,0,4,Q\nB,4,9,T\nC,0,6,Q\nC,6,9,T\n"
    (data / "log.csv").write_text(log)
    wizard = opened(qtbot, site, data / "collar.csv", data / "log.csv")
    press(qtbot, wizard, wizard.go)
    assert wizard.results.problems.text() == "Problems: none"
    assert wizard.results.files.rows.columns[0].values.tolist() == ["collar.csv", "log.csv"]
    press(qtbot, wizard, wizard.back)
    (data / "log.csv").write_text(log + "D,0,3,Q\n")
    press(qtbot, wizard, wizard.go)
    issues = wizard.results.issues.rows.columns[1]
    assert wizard.results.problems.text() == "Problems: 1"
    assert issues.text(0) == "log.csv"


def test_nothing_is_read_while_a_required_role_is_missing(qtbot, tmp_path):
    (tmp_path / "collar.csv").write_text("hole,east,north,elevation\nA,1,2,3\nB,4,5,6\nC,7,9,8\n")
    wizard = opened(qtbot, tmp_path, tmp_path / "collar.csv")
    choose(wizard.page.kind, "collar")
    rested(qtbot, wizard)
    name_column(wizard, 3, "")
    assert not wizard.go.isEnabled()
    assert "Elevation" in wizard.page.message.text()
    assert "collar.csv" in wizard.message.text()
    name_column(wizard, 3, "z")
    assert wizard.go.isEnabled()


def test_a_log_of_lower_limits_is_read_and_said_so(qtbot, tmp_path):
    (tmp_path / "钻孔.csv").write_text(COLLAR, encoding="utf-8")
    log = "孔号,层底深度,地层\n" + "".join(f"ZK{i},{10 + i},Q\nZK{i},60,T2\n" for i in range(8))
    (tmp_path / "地层.csv").write_text(log, encoding="utf-8")
    wizard = opened(qtbot, tmp_path, tmp_path / "钻孔.csv", tmp_path / "地层.csv")
    wizard.list.setCurrentRow(row_of(wizard, "地层.csv"))
    assert roles_shown(wizard) == ["hole", "to", "code"]
    assert "taken from the row above" in wizard.page.message.text()
    name_column(wizard, 2, "")
    assert not wizard.go.isEnabled(), "a code is still needed"
    name_column(wizard, 2, "code")
    press(qtbot, wizard, wizard.go)
    assert wizard.found.site.horizons["base of Q"].xyz[:, 2].tolist() == [890.25 - 2 * i for i in range(8)]


def logged(qtbot, folder):
    """A wizard that has read collars and logs of eight holes, at its list of horizons and problems."""
    (folder / "钻孔.csv").write_text(COLLAR, encoding="utf-8")
    (folder / "地层.csv").write_text(LOG, encoding="utf-8")
    wizard = opened(qtbot, folder, folder / "钻孔.csv", folder / "地层.csv")
    assert not wizard.build.isVisible(), "nothing is read yet"
    press(qtbot, wizard, wizard.go)
    return wizard


def test_horizons_are_built_from_codes_with_their_picks_in_3d_and_can_be_taken_back(qtbot, tmp_path):
    wizard = logged(qtbot, tmp_path)
    press(qtbot, wizard, wizard.build)
    page = wizard.horizons
    form, view = page.form, page.view

    def points():
        return {layer.horizon for layer in view.layers if layer.kind == "points"}

    assert view.isVisible()
    assert "holes" in view.layers
    assert not page.back.isEnabled()
    assert wizard.go.isEnabled(), "the page can be skipped"
    form.check("T2")
    form.limit.setCurrentIndex(form.limit.findData("top"))
    assert points() == {"Preview"}
    assert len(view.contents.points["Preview"]) == 8
    form.add.click()
    assert points() == {"top of T2"}
    form.check("T2")
    assert points() == {"top of T2", "Preview"}
    form.name.setText("floor")
    form.name.textEdited.emit("floor")
    form.add.click()
    assert "top of T2, floor" in page.words.text()
    press(qtbot, wizard, page.back)
    assert points() == {"top of T2"}
    assert "floor" not in form.place.order
    press(qtbot, wizard, wizard.back)
    press(qtbot, wizard, wizard.build)
    assert [one.name for one in wizard.built] == ["top of T2"], "it is kept while the problems are looked at"
    with qtbot.waitSignal(wizard.accepted):
        press(qtbot, wizard, wizard.go)
    (built,) = wizard.built
    assert set(built.order) == {"base of Q", "top of T2"}


def test_what_was_built_is_forgotten_when_the_files_are_read_again(qtbot, tmp_path):
    wizard = logged(qtbot, tmp_path)
    press(qtbot, wizard, wizard.build)
    wizard.horizons.form.check("Q")
    wizard.horizons.form.limit.setCurrentIndex(wizard.horizons.form.limit.findData("top"))
    wizard.horizons.form.add.click()
    for _ in range(2):
        press(qtbot, wizard, wizard.back)
    press(qtbot, wizard, wizard.go)
    assert wizard.pages.currentIndex() == 1
    assert not wizard.built


def test_horizons_of_the_wizard_are_steps_that_can_be_undone(app, tmp_path, monkeypatch):
    def act(wizard):
        wizard.show()
        app.qtbot.waitUntil(lambda: not wizard.running, timeout=30_000)
        press(app.qtbot, wizard, wizard.go)
        press(app.qtbot, wizard, wizard.build)
        form = wizard.horizons.form
        for code, limit, name in (("T2", "top", "rock"), ("Q", "base", "soil")):
            form.check(code)
            form.limit.setCurrentIndex(form.limit.findData(limit))
            form.name.setText(name)
            form.name.textEdited.emit(name)
            form.add.click()
        press(app.qtbot, wizard, wizard.go)
        return wizard.result()

    monkeypatch.setattr(ImportWizard, "exec", act)
    (tmp_path / "钻孔.csv").write_text(COLLAR, encoding="utf-8")
    (tmp_path / "地层.csv").write_text(LOG, encoding="utf-8")
    app.window.files.import_files([tmp_path / "钻孔.csv", tmp_path / "地层.csv"])
    app.idle()
    document, names = app.document, {"rock", "soil"}
    assert names < set(document.horizons)
    assert app.window.session.stack.count() == 2
    for _ in range(2):
        app.window.menus.undo.trigger()
        app.idle()
    assert not names & set(document.horizons)
    assert document.horizons


def test_several_columns_are_horizons(qtbot, tmp_path):
    rows = "".join(f"W{i},{i},{2 * i},50,{i + 10},{i + 20}\n" for i in range(1, 5))
    (tmp_path / "wells.csv").write_text("well,x,y,collar,T1,T2\n" + rows.replace(",13,", ",?,"))
    wizard = opened(qtbot, tmp_path, tmp_path / "wells.csv")
    choose(wizard.page.kind, "horizon columns")
    rested(qtbot, wizard)
    assert roles_shown(wizard) == ["hole", "x", "y", "", "", ""]
    assert "Horizon elevation" in wizard.page.message.text()
    assert not wizard.go.isEnabled()
    name_column(wizard, 4, "horizon elevation")
    assert wizard.go.isEnabled()
    name_column(wizard, 5, "horizon depth")
    assert roles_shown(wizard)[3:] == ["", "horizon depth", "horizon depth"], "all are depths, or none"
    assert not wizard.go.isEnabled(), "depths need a collar"
    name_column(wizard, 3, "z")
    assert wizard.page.table.item(3, 4).background().color().name() in BAD.values()
    press(qtbot, wizard, wizard.go)
    horizons = wizard.found.site.horizons
    assert {name: points.xyz[:, 2].tolist() for name, points in horizons.items()} == {
        "T1": [39, 38, 36],
        "T2": [29, 28, 27, 26],
    }
    again = opened(qtbot, tmp_path, tmp_path / "wells.csv")
    assert roles_shown(again) == ["hole", "x", "y", "z", "horizon depth", "horizon depth"]
    name_column(again, 4, "horizon elevation")
    name_column(again, 5, "")
    assert roles_shown(again)[3:] == ["z", "horizon elevation", ""]


def test_depths_named_as_elevations_are_told(qtbot, tmp_path):
    (tmp_path / "points.csv").write_text("x,y,z,depth\n1,2,3,30\n4,5,6,60\n8,7,9,90\n")
    wizard = opened(qtbot, tmp_path, tmp_path / "points.csv")
    choose(wizard.page.kind, "picks")
    rested(qtbot, wizard)
    assert "Column 'depth' is not used" in wizard.page.message.text()
    name_column(wizard, 3, "z")
    assert "is named as a depth but read as an elevation" in wizard.page.message.text()
    name_column(wizard, 2, "z")
    assert "Column 'depth' is not used" in wizard.page.message.text()


def test_a_role_given_to_another_column_leaves_the_first(qtbot, tmp_path):
    (tmp_path / "points.csv").write_text("x,y,z,w\n1,2,3,30\n4,5,6,60\n8,7,9,90\n")
    wizard = opened(qtbot, tmp_path, tmp_path / "points.csv")
    assert roles_shown(wizard) == ["x", "y", "z", ""]
    name_column(wizard, 3, "z")
    assert roles_shown(wizard) == ["x", "y", "", "z"]
    press(qtbot, wizard, wizard.go)
    points = next(iter(read_site(wizard.site_file).horizons.values()))
    assert points.xyz[:, 2].tolist() == [30, 60, 90]


def test_cells_that_are_no_numbers_are_red_and_listed_with_their_row(qtbot, tmp_path):
    (tmp_path / "points.csv").write_text("x,y,z\n1,2,3\n4,n/a,6\n8,7,9\n9,1,4\n")
    wizard = opened(qtbot, tmp_path, tmp_path / "points.csv")
    item = wizard.page.table.item(2, 1)
    assert item.background().color().name() in BAD.values()
    assert wizard.page.table.item(1, 1).background().style() == Qt.BrushStyle.NoBrush
    assert "(1 shown)" in wizard.page.message.text()
    press(qtbot, wizard, wizard.go)
    columns = wizard.results.issues.rows.columns
    found = [k for k in range(wizard.results.issues.rows.total) if columns[4].text(k) == "n/a"]
    assert [columns[2].text(k) for k in found] == ["3"]
    assert "4 rows read = 3 used + 1 listed" in wizard.results.balance.text()


def test_another_separator_is_read_again(qtbot, tmp_path):
    (tmp_path / "points.csv").write_text("x y z\n1 2 3\n4 5 6\n7 9 9\n")
    wizard = opened(qtbot, tmp_path, tmp_path / "points.csv")
    choose(wizard.page.separator, ";")
    rested(qtbot, wizard)
    assert len(wizard.drafts()[0].preview.header) == 1
    choose(wizard.page.separator, " ")
    rested(qtbot, wizard)
    assert wizard.drafts()[0].preview.header == ("x", "y", "z")


def test_lengths_in_feet_become_metres(qtbot, tmp_path):
    (tmp_path / "points.csv").write_text("x,y,z\n100,200,300\n400,500,600\n800,700,900\n")
    wizard = opened(qtbot, tmp_path, tmp_path / "points.csv")
    choose(wizard.page.unit, "ft")
    rested(qtbot, wizard)
    press(qtbot, wizard, wizard.go)
    points = next(iter(read_site(wizard.site_file).horizons.values()))
    assert points.xyz[0] == pytest.approx([30.48, 60.96, 91.44])


def test_feet_in_a_header_are_said_and_can_be_overruled(qtbot, tmp_path):
    (tmp_path / "points.csv").write_text("x (ft),y (ft),z (ft)\n100,200,300\n400,500,600\n800,700,900\n")
    wizard = opened(qtbot, tmp_path, tmp_path / "points.csv")
    assert wizard.page.unit.currentText() == "as in the headers: ft"
    press(qtbot, wizard, wizard.go)
    points = next(iter(read_site(wizard.site_file).horizons.values()))
    assert points.xyz[0] == pytest.approx([30.48, 60.96, 91.44])
    again = opened(qtbot, tmp_path, tmp_path / "points.csv")
    choose(again.page.unit, "m")
    rested(qtbot, again)
    press(qtbot, again, again.go)
    points = next(iter(read_site(again.site_file).horizons.values()))
    assert points.xyz[0] == pytest.approx([100, 200, 300])


def test_a_table_is_left_out_and_said_so(qtbot, tmp_path):
    (tmp_path / "points.csv").write_text("x,y,z\n1,2,3\n4,5,6\n8,7,9\n")
    (tmp_path / "notes.csv").write_text("who,what\nme,nothing\nyou,less\n")
    wizard = opened(qtbot, tmp_path, tmp_path / "points.csv", tmp_path / "notes.csv")
    assert wizard.list.currentRow() == row_of(wizard, "notes.csv")
    assert not wizard.go.isEnabled()
    choose(wizard.page.kind, "skip")
    rested(qtbot, wizard)
    press(qtbot, wizard, wizard.go)
    issues = wizard.results.issues.rows.columns
    reasons = [issues[5].text(k) for k in range(wizard.results.issues.rows.total) if issues[1].text(k) == "notes.csv"]
    assert reasons == ["The mapping leaves this table out"]


def test_a_mapping_is_remembered_for_the_same_header(qtbot, tmp_path):
    text = "A1,B1,C1,D1\n500001.5,3100002,30,1\n500404,3100005,60,2\n500807,3100307,90,3\n"
    (tmp_path / "one.csv").write_text(text)
    wizard = opened(qtbot, tmp_path, tmp_path / "one.csv")
    choose(wizard.page.kind, "picks")
    rested(qtbot, wizard)
    for column, role in enumerate(("x", "y", "", "z")):
        name_column(wizard, column, role)
    press(qtbot, wizard, wizard.go)
    (tmp_path / "two.csv").write_text(str(text).replace("30,1", "31,9"))
    again = opened(qtbot, tmp_path, tmp_path / "two.csv")
    assert again.drafts()[0].remembered
    assert roles_shown(again) == ["x", "y", "", "z"]
    assert again.site_file.name == "site-2.toml"


def test_a_missing_file_is_told_and_the_wizard_goes_on(qtbot, tmp_path):
    wizard = opened(qtbot, tmp_path, tmp_path / "nothing.csv")
    assert "nothing.csv" in wizard.page.message.text()
    assert "nothing to read" in wizard.message.text()
    assert not wizard.go.isEnabled()
    (tmp_path / "points.csv").write_text("x,y,z\n1,2,3\n4,5,6\n8,7,9\n")
    wizard.add_files([tmp_path / "points.csv"])
    rested(qtbot, wizard)
    press(qtbot, wizard, wizard.go)
    assert "3 rows read = 3 used" in wizard.results.balance.text()


def test_files_that_cannot_be_read_do_not_hide_the_others_and_are_listed(qtbot, tmp_path):
    tables = tmp_path / "tables"
    (tables / "inner").mkdir(parents=True)
    (tables / "empty.csv").write_bytes(b"")
    (tables / ".hidden").write_bytes(b"")
    (tables / "photo.jpg").write_bytes(bytes(range(256)))
    (tables / "points.csv").write_text("x,y,z\n1,2,3\n4,5,6\n8,7,9\n")
    wizard = opened(qtbot, tmp_path, tables)
    assert [draft.title for draft in wizard.drafts()] == ["empty.csv", "photo.jpg", "points.csv"], "a folder's files"
    assert [draft.fault is not None for draft in wizard.drafts()] == [True, True, False]
    assert "The file is empty" in wizard.page.message.text()
    assert "left out" in wizard.page.message.text()
    press(qtbot, wizard, wizard.go)
    assert list(wizard.found.site.horizons) == ["points"]
    assert "tables/empty.csv" in [issue.file for issue in wizard.found.issues]


def test_axes_that_look_exchanged_are_told_and_one_button_mends_them(qtbot, tmp_path):
    rows = "".join(f"ZK{i},{3100000 + 60 * i}.5,{500000 + 40 * i}.5,{900 - i},60\n" for i in range(6))
    (tmp_path / "孔.csv").write_text(f"孔号,X,Y,孔口高程,孔深\n{rows}", encoding="utf-8")
    feet = rows.replace("31000", "22960")  # state plane coordinates in feet look alike, and are as they should be
    (tmp_path / "collars.csv").write_text(f"hole,x,y,z,depth\n{feet}", encoding="utf-8")
    wizard = opened(qtbot, tmp_path, tmp_path / "孔.csv", tmp_path / "collars.csv")
    assert [draft.exchanged for draft in wizard.drafts()] == [True, False]
    assert "appear to be exchanged" in wizard.page.message.text()
    press(qtbot, wizard, wizard.page.exchange)
    assert roles_shown(wizard)[1:3] == ["y", "x"]
    assert not wizard.page.exchange.isVisible()
    wizard.list.setCurrentRow(1)
    wizard.remove.click()
    press(qtbot, wizard, wizard.go)
    assert wizard.found.site.holes[0].xyz[0, :2].tolist() == [500000.5, 3100000.5]


def test_collars_without_elevation_may_stand_on_a_ground(qtbot, tmp_path):
    (tmp_path / "collar.csv").write_text("hole,x,y,depth\n" + "".join(f"A{i},{i},{i},9\n" for i in range(1, 5)))
    wizard = opened(qtbot, tmp_path, tmp_path / "collar.csv")
    assert "Elevation" in wizard.page.message.text()
    assert "ground" in wizard.page.message.text()
    assert not wizard.go.isEnabled()
    head = "ncols 3\nnrows 3\nxllcorner -5\nyllcorner -5\ncellsize 10\n"
    (tmp_path / "ground.asc").write_text(head + "7 7 7\n" * 3)
    wizard.add_files([tmp_path / "ground.asc"])
    rested(qtbot, wizard)
    assert wizard.go.isEnabled()


def test_cancel_takes_away_what_was_written_and_a_file_that_was_there_is_named_before(qtbot, tmp_path):
    (tmp_path / "points.csv").write_text("x,y,z\n1,2,3\n4,5,6\n8,7,9\n")
    wizard = opened(qtbot, tmp_path, tmp_path / "points.csv")
    assert "all points are of 'points'" in wizard.page.message.text()
    press(qtbot, wizard, wizard.go)
    assert (tmp_path / "site.toml").exists()
    wizard.reject()
    assert [path.name for path in tmp_path.glob("*.toml")] == []
    (tmp_path / "own.toml").write_text("")
    again = opened(qtbot, tmp_path, tmp_path / "points.csv")
    again.target.setText(str(tmp_path / "own"))
    assert "own.toml already exists" in again.message.text()
    press(qtbot, again, again.go)
    again.reject()
    assert (tmp_path / "own.toml").exists()


def test_several_tables_are_removed_at_once(qtbot, tmp_path):
    names = [f"notes{k}.csv" for k in range(6)]
    for name in (*names, "points.csv"):
        (tmp_path / name).write_text("x,y,z\n1,2,3\n4,5,6\n8,7,9\n" if name == "points.csv" else "who,what\nme,7\n")
    wizard = opened(qtbot, tmp_path, *sorted(tmp_path.glob("*.csv")))
    assert "… (6)" in wizard.message.text()
    for row in range(6):
        wizard.list.item(row).setSelected(True)
    wizard.remove.click()
    assert [draft.title for draft in wizard.drafts()] == ["points.csv"]
    assert wizard.go.isEnabled()


def test_a_broken_memory_counts_as_empty(tmp_path):
    path = tmp_path / "mappings.json"
    path.write_text("[{]")
    assert Memory(path).recall() == ()
    (tmp_path / "points.csv").write_text("x,y,z\n1,2,3\n4,5,6\n8,7,9\n")
    drafts = drafts_of([tmp_path / "points.csv"], (), progress=lambda stage, share: None)
    Memory(path).keep(drafts)
    ((header, mapping),) = Memory(path).recall()
    assert (header, mapping.kind) == (("x", "y", "z"), "picks")


def test_no_site_file_is_written_over(tmp_path):
    assert free_name(tmp_path).name == "site.toml"
    (tmp_path / "site.toml").touch()
    assert free_name(tmp_path).name == "site-2.toml"
