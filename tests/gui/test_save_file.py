"""Where files go: an ending that was not typed is added before anybody is asked whether to replace a file."""

from __future__ import annotations

from pathlib import Path

import pytest
from panel_samples import FAULT, fitted, sample_site
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication, QFileDialog, QLineEdit, QMessageBox, QPushButton, QWidget

from geofit.gui import save_file
from geofit.gui.dialogs.export_step import ExportDialog
from geofit.gui.dialogs.plan_sheet import PlanSheetDialog
from geofit.gui.save_file import ask_save_file

STEP, IGES = "STEP files (*.step *.stp)", "IGES files (*.igs *.iges)"
YES, NO = QMessageBox.StandardButton.Yes, QMessageBox.StandardButton.No


@pytest.fixture
def typed(monkeypatch):
    """What the user types into the dialog and the kind chosen there, one pair each time; nothing more: cancel."""
    given = []

    def take(*_, **options):
        assert options["options"] == QFileDialog.Option.DontConfirmOverwrite
        return given.pop(0) if given else ("", "")

    monkeypatch.setattr(QFileDialog, "getSaveFileName", take)
    return given


class Asked(list):
    """The questions that were asked; ``answers`` are given in turn."""

    def __init__(self):
        super().__init__()
        self.answers = []


@pytest.fixture
def asked(monkeypatch):
    """The questions whether to replace a file."""
    seen = Asked()

    def answer(box):
        seen.append(box.text())
        return seen.answers.pop(0)

    monkeypatch.setattr(QMessageBox, "exec", answer)
    return seen


@pytest.mark.parametrize(
    ("name", "kind", "file", "found"),
    [
        ("dam", "", "dam.step", STEP),
        ("dam", IGES, "dam.igs", IGES),
        ("dam.v2", STEP, "dam.v2.step", STEP),
        ("dam.stp", IGES, "dam.stp", STEP),
        ("DAM.IGES", STEP, "DAM.iges", IGES),
    ],
)
def test_a_name_without_a_known_ending_gets_that_of_the_chosen_kind(qtbot, tmp_path, typed, name, kind, file, found):
    window = QWidget()
    qtbot.addWidget(window)
    typed.append((str(tmp_path / name), kind))
    assert ask_save_file(window, "Export", tmp_path, f"{STEP};;{IGES}") == (tmp_path / file, found)


def test_a_file_that_exists_is_replaced_only_by_consent_and_else_asked_for_again(qtbot, tmp_path, typed, asked):
    window = QWidget()
    qtbot.addWidget(window)
    (tmp_path / "dam.step").touch()
    typed += [(str(tmp_path / "dam"), STEP), (str(tmp_path / "weir"), STEP)]
    asked.answers.append(NO)
    assert ask_save_file(window, "Export", tmp_path, STEP) == (tmp_path / "weir.step", STEP)
    assert asked == ["dam.step already exists. Replace it?"]
    typed.append((str(tmp_path / "dam"), STEP))
    asked.answers.append(NO)
    assert ask_save_file(window, "Export", tmp_path, STEP) is None
    typed.append((str(tmp_path / "dam"), STEP))
    asked.answers.append(YES)
    assert ask_save_file(window, "Export", tmp_path, STEP) == (tmp_path / "dam.step", STEP)


def test_the_dialog_that_opens_asks_once(qtbot, tmp_path, asked):
    """The real dialog: its own question would come before the ending is added."""
    window = QWidget()
    qtbot.addWidget(window)
    (tmp_path / "dam.step").touch()

    def accept():
        dialog = QApplication.activeModalWidget()
        dialog.findChild(QLineEdit, "fileNameEdit").setText("dam.step")
        dialog.accept()

    asked.answers.append(YES)
    QTimer.singleShot(500, accept)
    assert ask_save_file(window, "Export", tmp_path / "other", STEP) == (tmp_path / "dam.step", STEP)
    assert asked == ["dam.step already exists. Replace it?"]


@pytest.mark.usefixtures("own_settings")
def test_a_step_file_whose_name_was_typed_is_replaced_only_by_consent(qtbot, tmp_path, asked):
    dialog = ExportDialog({FAULT: fitted(FAULT)})
    qtbot.addWidget(dialog)
    dialog.show()
    dialog.target.setText(str(tmp_path / "dam"))
    for name in ("dam.step", "dam_certificate.pdf"):
        (tmp_path / name).write_text("another's", encoding="utf-8")
    asked.answers.append(NO)
    dialog.go.click()
    assert asked == ["dam.step, dam_certificate.pdf already exist. Replace them?"]
    assert not dialog.running
    assert (tmp_path / "dam.step").read_text(encoding="utf-8") == "another's"
    dialog.certificate.setChecked(False)
    asked.answers.append(YES)
    dialog.go.click()
    qtbot.waitUntil(lambda: not dialog.running, timeout=120_000)
    assert asked[1:] == ["dam.step already exists. Replace it?"]
    assert (tmp_path / "dam.step").read_text(encoding="utf-8").startswith("ISO-10303-21")


@pytest.mark.usefixtures("own_settings")
def test_a_step_file_that_was_agreed_on_when_it_was_chosen_is_not_asked_about_again(
    qtbot, tmp_path, typed, asked, monkeypatch
):
    dialog, begun = ExportDialog({FAULT: fitted(FAULT)}), []
    qtbot.addWidget(dialog)
    monkeypatch.setattr(dialog, "begin", lambda *work, **_: begun.append(work))
    dialog.certificate.setChecked(False)
    (tmp_path / "dam.step").touch()
    typed.append((str(tmp_path / "dam"), STEP))
    asked.answers.append(YES)
    button = next(one for one in dialog.findChildren(QPushButton) if one.text() == "&Browse…")
    button.click()
    dialog.go.click()
    assert (len(asked), len(begun)) == (1, 1)
    # The agreement was for that time, and for that file.
    asked.answers += [NO, NO]
    dialog.go.click()
    (tmp_path / "weir.step").touch()
    dialog.target.setText(str(tmp_path / "weir.step"))
    dialog.go.click()
    assert (len(asked), len(begun)) == (3, 1)


@pytest.mark.usefixtures("own_settings")
def test_sheets_whose_name_was_typed_are_replaced_only_by_consent(qtbot, tmp_path, asked):
    dialog = PlanSheetDialog(sample_site(), {FAULT: fitted(FAULT)}, FAULT, tmp_path)
    qtbot.addWidget(dialog)
    dialog.show()
    dialog.forms["svg"].setChecked(True)
    for form in ("pdf", "svg"):
        (tmp_path / f"plan.{form}").write_text("another's", encoding="utf-8")
    asked.answers.append(NO)
    dialog.go.click()
    assert asked == ["plan.pdf, plan.svg already exist. Replace them?"]
    assert not dialog.running
    assert (tmp_path / "plan.pdf").read_text(encoding="utf-8") == "another's"


def site(folder: Path) -> Path:
    folder.mkdir()
    rows = [f"{10 * i},{10 * j},{100 + i - 0.5 * j + 0.1 * (i * j % 3)},a" for i in range(6) for j in range(6)]
    (folder / "p.csv").write_text("x,y,z,horizon\n" + "\n".join(rows) + "\n", encoding="utf-8")
    (folder / "site.toml").write_text('[site]\nname = "S"\n[[picks]]\nfile = "p.csv"\n', encoding="utf-8")
    return folder / "site.toml"


def test_another_project_and_its_surfaces_are_replaced_only_by_consent(app, tmp_path, typed, asked):
    app.window.files.open(site(tmp_path / "one"))
    app.idle()
    app.window.fitting.fit("a")
    app.idle()
    typed.append((str(tmp_path / "dam"), ""))
    app.window.files.save_as()
    app.idle()
    project, surfaces = tmp_path / "dam.geofit", tmp_path / "dam_surfaces"
    before, files = project.read_bytes(), sorted(surfaces.iterdir())
    assert len(files) == 1

    app.window.files.open(site(tmp_path / "two"))
    app.idle()
    typed.append((str(tmp_path / "dam"), ""))
    asked.answers.append(NO)
    app.window.files.save_as()
    app.idle()
    assert asked == ["dam.geofit already exists. Replace it?"]
    assert project.read_bytes() == before
    assert sorted(surfaces.iterdir()) == files


def test_an_export_replaces_a_file_only_by_consent(app, tmp_path, typed, asked):
    app.window.files.open(site(tmp_path / "one"))
    app.idle()
    app.window.fitting.fit("a")
    app.idle()
    file = tmp_path / "geo.igs"
    file.write_text("precious", encoding="utf-8")
    typed.append((str(tmp_path / "geo"), ""))
    asked.answers.append(NO)
    app.window.delivering.export_other()
    app.idle()
    assert asked == ["geo.igs already exists. Replace it?"]
    assert file.read_text(encoding="utf-8") == "precious"
    typed.append((str(tmp_path / "geo"), ""))
    asked.answers.append(YES)
    app.window.delivering.export_other()
    app.idle()
    assert file.read_text(encoding="utf-8") != "precious"


def test_an_export_tells_which_names_the_format_cannot_write(app, tmp_path):
    app.window.files.open(site(tmp_path / "one"))
    app.idle()
    app.window.fitting.fit("a")
    app.idle()
    told = []
    app.window.delivering.reported.connect(told.append)
    app.window.delivering.write("iges", tmp_path / "dam.igs", {"覆盖层": app.document.surface("a")})
    app.idle()
    (text,) = told
    assert "dam.igs" in text
    assert "覆盖层: IGES names are ASCII; in the file it is 'HORIZON'" in text


def test_every_dialog_that_saves_asks_the_same_way():
    """Another use of the system's dialog would bring the silent replacement back."""
    gui = Path(save_file.__file__).parent
    users = [path.name for path in gui.rglob("*.py") if "getSaveFileName" in path.read_text(encoding="utf-8")]
    assert users == ["save_file.py"]
