"""A site that grows, through the window: files added, files changed on the disk, what moved."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.io.site_file import read_site
from geofit.project.provenance import Row

NAME = "base of clay"
HEAD = "hole,x,y,z,horizon\n"


def lines(n, seed, prefix="B", shift=0.0):
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(0, 400, (2, n))
    z = 100 + 0.05 * x + 4 * np.sin(x / 60) * np.cos(y / 80) + rng.normal(0, 0.05, n) + shift
    return [f"{prefix}{k},{a:.2f},{b:.2f},{c:.3f},{NAME}" for k, (a, b, c) in enumerate(zip(x, y, z, strict=True))]


def written(folder, rows, name="picks.csv"):
    (folder / name).write_text(HEAD + "\n".join(rows) + "\n", encoding="utf-8")


@pytest.fixture
def opened(app, tmp_path):
    folder = tmp_path / "site"
    folder.mkdir()
    written(folder, lines(60, 1))
    (folder / "site.toml").write_text(
        '[site]\nname = "Dam"\n[[picks]]\nfile = "picks.csv"\nkind = "borehole"\n', encoding="utf-8"
    )
    app.desktop.session.begin(read_site(folder / "site.toml"), folder / "site.toml")
    app.idle()
    app.window.fitting.fit(NAME)
    app.idle()
    return folder


def test_an_added_file_brings_new_holes_and_the_band_of_before_is_tested(app, qtbot, opened):
    window, document = app.window, app.document
    panel = window.panels.changes
    assert "have not changed" in panel.pages.text
    written(opened, lines(25, 5, "N"), "more.csv")
    window.living.add([opened / "more.csv"])
    app.idle()
    assert len(document.site.horizons[NAME]) == 85
    assert document.dirty
    assert document.stale(NAME)
    assert f"{NAME}: 25 new, 0 corrected, 0 gone" in panel.pages.text
    assert panel.isVisible()
    # The button of the panel fits.
    panel.pages.button.click()
    app.idle()
    comparison = document.comparison(NAME)
    assert comparison is not None
    assert panel.pages.text == ""
    assert panel.table.rows.total == 25
    assert str(comparison.test.inside) in panel.verdict.text()
    assert panel.figures.text().startswith(f"{NAME} moved by")
    # A click on a row shows the place.
    chosen = []
    panel.place_chosen.connect(lambda *place: chosen.append(place))
    panel.table.selectRow(0)
    one = comparison.test.contacts[panel.table.current]
    assert chosen == [(one.x, one.y, one.z)]
    # Back to the state before: the site, its surface, and nothing to compare.
    while window.session.stack.canUndo() and len(document.site.horizons[NAME]) > 60:
        window.menus.undo.trigger()
        app.idle()
    assert not document.stale(NAME)
    assert document.surface(NAME) is not None
    assert "have not changed" in panel.pages.text
    window.menus.redo.trigger()
    window.menus.redo.trigger()
    app.idle()
    assert document.comparison(NAME) is not None


def test_changed_files_are_offered_and_exclusions_survive_or_are_listed(app, qtbot, opened):
    window, document = app.window, app.document
    window.fitting.exclude(NAME, [Row("picks.csv", 5), Row("picks.csv", 20)])
    rows = lines(60, 1)
    del rows[18]
    window.living.look()
    assert not window.panels.offer.isVisible()
    written(opened, [*lines(3, 7, "NEW"), *rows])
    window.living.look()
    bar = window.panels.offer
    assert bar.isVisible()
    assert "picks.csv" in bar.words.text()
    bar.take.click()
    app.idle()
    assert not bar.isVisible()
    assert document.state.excluded[NAME] == {Row("picks.csv", 8)}
    assert window.session.stack.undoText() == "New data: picks.csv"
    text = window.panels.changes.pages.text
    assert f"{NAME}: 3 new, 0 corrected, 1 gone" in text
    assert "exclusion of picks.csv row 20 is lost" in text
    window.living.look()
    assert not bar.isVisible()
    # The same bytes again change nothing.
    window.living.reload()
    app.idle()
    assert window.session.stack.undoText() == "New data: picks.csv"


def test_not_now_puts_the_offer_off_until_the_files_change_again(app, opened):
    window = app.window
    written(opened, lines(61, 1))
    window.living.look()
    window.panels.offer.later.click()
    window.living.look()
    assert not window.panels.offer.isVisible()
    written(opened, lines(62, 1))
    window.living.look()
    assert window.panels.offer.isVisible()


def test_the_project_and_a_crash_keep_the_earlier_state(app, qtbot, opened, tmp_path):
    from geofit.project.journal import unfinished

    window, document = app.window, app.document
    written(opened, [*lines(60, 1), *lines(20, 5, "N")])
    window.living.reload()
    app.idle()
    window.fitting.fit(NAME)
    app.idle()
    before = document.comparison(NAME)
    state = document.state
    (cut,) = unfinished(app.killed(tmp_path / "killed"))
    window.files.recover(cut)
    app.idle()
    assert document.state == state
    again = document.comparison(NAME)
    assert again.change.mean == before.change.mean
    residuals = [[one.residual for one in each.test.contacts] for each in (again, before)]
    assert np.array_equal(*residuals, equal_nan=True)
    # Undone beyond the change of data, the former points are back.
    for _ in range(2):
        window.menus.undo.trigger()
    app.idle()
    assert len(document.site.horizons[NAME]) == 60
    for _ in range(2):
        window.menus.redo.trigger()
    app.idle()
    window.files.save_to(tmp_path / "dam.geofit")
    app.idle()
    window.files.open(tmp_path / "dam.geofit")
    app.idle()
    assert document.state == state
    assert document.comparison(NAME).change.mean == pytest.approx(before.change.mean, abs=1e-9)


def test_the_report_tells_what_moved(app, opened):
    window, document = app.window, app.document
    written(opened, [*lines(60, 1), *lines(20, 5, "N", shift=3.0)])
    window.living.reload()
    app.idle()
    window.fitting.fit(NAME)
    app.idle()
    from geofit.report.gather import horizon_report

    result = window.delivering.result(NAME, document.surface(NAME))
    found = horizon_report(result)
    assert found.change.too_narrow
    assert len(found.change.contacts) == 20
    assert "change" in found.pictures


def test_a_file_that_cannot_be_added_leaves_everything_as_it_was(app, opened):
    (opened / "junk.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    state = app.document.state
    app.window.living.add([opened / "junk.csv"])
    app.qtbot.waitUntil(app.rests)
    (error,) = app.failures
    app.failures.clear()
    assert error.file == "junk.csv"
    assert app.document.state is state
