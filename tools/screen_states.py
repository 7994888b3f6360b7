"""The states of the application that the pictures show, in the order of a first user's way."""

from __future__ import annotations

import io
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image
from PySide6.QtCore import QBuffer, QCoreApplication, QEvent, QSettings, Qt
from PySide6.QtWidgets import QApplication, QDialog, QWidget

from geofit.bodies.settings import BodySettings
from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.data.site import Site
from geofit.geometry.mesh import Mesh
from geofit.gui.desktop import Desktop
from geofit.gui.dialogs.error import ErrorDialog
from geofit.gui.dialogs.export_step import ExportDialog
from geofit.gui.dialogs.issues import IssuesDialog
from geofit.gui.dialogs.preferences import PreferencesDialog
from geofit.gui.dialogs.report import ReportDialog
from geofit.gui.dialogs.shortcuts import ShortcutsDialog
from geofit.gui.main_window import MainWindow
from geofit.gui.wizard.import_wizard import ImportWizard, memory_file
from geofit.gui.worker import tasks
from geofit.io.export.triangles import write_ply
from geofit.project.body_record import Intervals
from geofit.report.result import HorizonResult
from geofit.sample import write_site

__all__ = ["take"]

#: Logical pixels of the main window.
SIZE = 1280, 800
#: The horizon that most pictures show.
SHOWN = "T2-T1"
#: A fixed place, so that the paths in the pictures are the same everywhere.
FOLDER = Path(tempfile.gettempdir()) / "dam site"


def take(out: Path, sets: list[str], states: tuple[str, ...]) -> None:
    """Take some sets (``en-light-1x``); all of one scale, that of this process."""
    QSettings.setDefaultFormat(QSettings.Format.IniFormat)
    shutil.rmtree(FOLDER, ignore_errors=True)
    write_site(FOLDER)
    desktop = Desktop()
    # A dialog would wait for somebody to close it.
    MainWindow.fail = _fail  # type: ignore[method-assign]
    for name in sets:
        language, theme, _ = name.split("-")
        folder = out / name
        if not states:
            shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True, exist_ok=True)
        print(name, flush=True)
        _Set(desktop, folder, states).take("zh_CN" if language == "zh" else "en", theme)
    desktop.window.leave_without_asking()
    desktop.session.end()
    shutil.rmtree(FOLDER)


class _Set:
    """One set: a language and a theme."""

    def __init__(self, desktop: Desktop, folder: Path, states: tuple[str, ...]) -> None:
        self.desktop, self.folder, self.states = desktop, folder, states

    @property
    def window(self) -> MainWindow:
        return self.desktop.window

    def take(self, language: str, theme: str) -> None:
        self.desktop.session.begin(Site("", {}), None)
        self.desktop.preferences.theme = "light" if theme == "light" else "dark"
        self.window._set_theme(theme)
        self.desktop.change_language(language)
        self.window.show()
        self.window.resize(*SIZE)
        QSettings().setValue("folder", str(FOLDER))
        self.idle()
        for state in (
            self.start, self.wizard, self.site, self.fitted, self.residuals, self.plan, self.section, self.seams,
            self.adjust, self.checks, self.prediction, self.export, self.report, self.small, self.bodies, self.morph,
        ):  # fmt: skip
            state()

    def start(self) -> None:
        self.shoot("01_start", self.window)

    def wizard(self) -> None:
        folder = FOLDER / "import"
        shutil.rmtree(folder, ignore_errors=True)  # of the set before
        memory_file().unlink(missing_ok=True)
        folder.mkdir()
        text = (FOLDER / "collar.csv").read_text("utf-8-sig").splitlines()
        cells = text[4].split(",")
        text[4] = ",".join([*cells[:3], "1 5o2", *cells[4:]])
        (folder / "collar.csv").write_text("\n".join(text) + "\n", encoding="utf-8")
        for name in ("survey.csv", "lithology.csv", "structures.csv", "风化.csv"):
            shutil.copy(FOLDER / name, folder / name)
        wizard = ImportWizard(sorted(folder.glob("*.csv")), folder, self.window)
        wizard.show()
        self.until(lambda: not wizard.running and wizard.list.count() > 0)
        wizard.list.setCurrentRow(0)
        self.shoot("02_import", wizard)
        wizard.go.click()
        self.until(lambda: not wizard.running)
        self.shoot("03_import_result", wizard)
        wizard.build.click()
        assert wizard.horizons is not None
        form = wizard.horizons.form
        form.check(*(form.codes.item(row, 0).text() for row in range(2)))
        self.idle(1.0)
        self.shoot("24_import_build", wizard)
        wizard.reject()
        self.close(wizard)

    def site(self) -> None:
        self.window.files.open(FOLDER / "site.toml")
        self.idle()
        self.window.panels.layout.arrange()
        self.window.actions_.exaggerations.actions()[1].trigger()
        self.shoot("04_site", self.window)

    def fitted(self) -> None:
        self.trigger("fit_all")
        self.window.panels.tree.horizon_chosen.emit(SHOWN)
        self.idle()
        self.shoot("05_all_fitted", self.window)
        self.alone()
        self.layer("points", colour_by="deviation")
        self.window.panels.reveal("histogram")
        self.shoot("06_deviation", self.window)

    def residuals(self) -> None:
        self.window.panels.reveal("residuals")
        self.trigger("worst")
        self.shoot("07_worst_point", self.window)
        self.trigger("home")

    def plan(self) -> None:
        self.window.panels.reveal("plan")
        self.trigger("top")
        self.shoot("08_plan", self.window)
        self.trigger("iso")

    def section(self) -> None:
        self.alone(every=True)
        self.window.actions_["section"].setChecked(True)
        self.idle()
        self.shoot("09_section", self.window)
        self.window.actions_["section"].setChecked(False)
        self.alone()

    def seams(self) -> None:
        self.window.panels.reveal("seams")
        self.window.actions_["seams"].setChecked(True)
        self.layer("points", visible=False)
        self.shoot("10_seams", self.window)
        self.layer("points", visible=True)
        self.window.actions_["seams"].setChecked(False)

    def adjust(self) -> None:
        self.window.actions_["control_points"].setChecked(True)
        control = self.window.panels.adjust.control
        surface = self.window.session.document.surface(SHOWN)
        assert surface is not None
        assert surface.accuracy is not None
        worst = surface.points.xyz[surface.accuracy.worst[0]] - surface.origin
        patch = next(one for one in surface.patches if one.name == surface.accuracy.patch[surface.accuracy.worst[0]])
        nearest = np.linalg.norm(patch.control - worst, axis=2)
        i, j = np.unravel_index(nearest.argmin(), nearest.shape)
        self.window.panels.view.control_picked.emit(SHOWN, patch.name, int(i), int(j))
        self.window.panels.reveal("residuals")
        control.dz.setValue(0.5)
        self.idle(1.5)
        self.shoot("11_adjust", self.window)
        control.dz.setValue(0.0)
        self.window.actions_["control_points"].setChecked(False)
        self.window.panels.reveal("fit")

    def checks(self) -> None:
        self.trigger("check_order")
        self.shoot("12_checks", self.window)

    def prediction(self) -> None:
        self.window.panels.reveal("prediction")
        self.trigger("examine")
        self.layer("surface", colour_by="standard deviation")
        self.shoot("13_off_the_data", self.window)

    def export(self) -> None:
        surfaces = self.window.session.document.surfaces()
        verdicts = {name: found for name in surfaces if (found := self.window.showing.verdict(name)) is not None}
        dialog = ExportDialog(surfaces, self.window, verdicts)
        for row in range(2, dialog.horizons.count()):
            dialog.horizons.item(row).setCheckState(Qt.CheckState.Unchecked)
        dialog.show()
        dialog.go.click()
        self.until(lambda: not dialog.running)
        self.shoot("14_export_step", dialog)
        self.close(dialog)

    def report(self) -> None:
        document = self.window.session.document
        site = document.site_in_use()
        results = [HorizonResult(s, site, prediction=document.prediction(n)) for n, s in document.surfaces().items()]
        self.dialog("15_report", ReportDialog(site, results, self.window))

    def small(self) -> None:
        error = InputError(
            message("io.separator-not-character", "The separator {sep!r} is not one character", sep=";;"),
            message("io.give-separator", "Give one character, 'tab' or 'space'."),
            file="lithology.csv",
        )
        self.dialog("16_error", ErrorDialog(self.window.files.tr("Open {name}").format(name="site.toml"), error,
                                            self.window))  # fmt: skip
        self.dialog("17_preferences", PreferencesDialog(self.desktop.preferences, self.window))
        self.dialog("18_shortcuts", ShortcutsDialog(self.window.menuBar()))
        self.dialog("19_import_problems", IssuesDialog(self.window.session.document.site, self.window))
        self.window.panels.reveal("log")
        self.shoot("20_log", self.window)

    def bodies(self) -> None:
        for code in ("ORE", "GABBRO"):
            self.window.bodies.fit("", Intervals((code,), "bodies.toml"), BodySettings())
            self.idle()
        layers, panels = self.window.panels.view.layers, self.window.panels
        for layer in layers:
            if layer.kind in ("surface", "points", "ground", "dips", "suggestions"):
                layers.change(layer.key, visible=False)
        self.window.bodies.showing.choose("ORE")
        panels.reveal("bodies")
        result = self.window.session.document.body("ORE")
        assert result is not None
        middle = result.mesh.vertices.mean(axis=0) + result.body.origin
        self.window.showing.line = middle[:2] + np.array([[-170.0, -60.0], [170.0, 60.0]])
        self.window.actions_["section"].setChecked(True)
        self.window.showing.show_section()
        self.zoom("body:ORE")
        self.shoot("21_bodies", self.window)
        self.window.actions_["section"].setChecked(False)
        panels.reveal("body_figures")
        panels.body_figures.strata.click()
        self.shoot("22_body_figures", self.window)

    def morph(self) -> None:
        """Between the lens and a lens that was squeezed and moved."""
        document, panels = self.window.session.document, self.window.panels
        result = document.body("ORE")
        assert result is not None
        mesh = result.mesh
        moved = Mesh(
            mesh.vertices * [0.7, 1.4, 1.2] + [35.0, 10.0, -8.0], mesh.triangles, np.zeros(len(mesh.triangles), int),
            np.zeros((len(mesh.triangles), 3, 2)), np.asarray(result.body.origin, float), ("ORE 2",),
        )  # fmt: skip
        write_ply({"ORE 2": moved}, FOLDER / "ORE 2.ply")
        self.window.bodies.take_mesh(FOLDER / "ORE 2.ply")
        self.idle()
        for name in document.state.bodies:
            self.window.bodies.styles.restyle(name, visible=False)
        panels.reveal("morph")
        rows = panels.morph.list
        for k in range(rows.count()):
            on = rows.item(k).text().startswith("ORE")
            rows.item(k).setCheckState(Qt.CheckState.Checked if on else Qt.CheckState.Unchecked)
        panels.morph.run.click()
        self.idle()
        self.zoom("morph")
        panels.morph.timeline.put(0.5)
        panels.morph.moved.emit(0.5)
        panels.morph.rested.emit(0.5)
        self.idle(1.0)
        self.shoot("23_metamorphosis", self.window)

    def zoom(self, key: str) -> None:
        self.window.panels.view.zoom_to(key)
        self.idle(1.0)

    def dialog(self, name: str, dialog: QDialog) -> None:
        dialog.show()
        self.shoot(name, dialog)
        self.close(dialog)

    def close(self, dialog: QDialog) -> None:
        dialog.close()
        dialog.deleteLater()
        self.idle()

    def trigger(self, name: str) -> None:
        self.window.actions_[name].trigger()
        self.idle()

    def layer(self, kind: str, **changes: object) -> None:
        layers = self.window.panels.view.layers
        key = f"{kind}:{SHOWN}"
        # Triangles are made beside the window, and come when they are ready.
        self.until(lambda: key in layers and changes.get("colour_by", "plain") in layers[key].choices)
        layers.change(key, **changes)
        self.idle()

    def alone(self, *, every: bool = False) -> None:
        """Show one horizon, or every one."""
        layers = self.window.panels.view.layers
        for layer in layers:
            if layer.kind in ("surface", "points"):
                layers.change(layer.key, visible=every or layer.horizon == SHOWN)
        self.idle()

    def idle(self, seconds: float = 0.3) -> None:
        """Wait until nothing runs, and everything is drawn."""
        self.until(lambda: not self.window.activity.busy and not tasks())
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            _events()

    def until(self, done: Callable[[], bool], seconds: float = 180.0) -> None:
        end = time.monotonic() + seconds
        _events()
        while not done():
            if time.monotonic() > end:
                raise TimeoutError("the application is still busy")
            _events()

    def shoot(self, name: str, widget: QWidget) -> None:
        """Write a picture with a palette of 256 colours: a third of the size, and no eye sees it."""
        self.idle()
        if self.states and not name.startswith(self.states):
            return
        buffer = QBuffer()
        buffer.open(QBuffer.OpenModeFlag.WriteOnly)
        widget.grab().save(buffer, "PNG")  # type: ignore[call-overload]
        picture = Image.open(io.BytesIO(buffer.data().data())).convert("RGB")
        picture = picture.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=2, dither=Image.Dither.NONE)
        picture.save(self.folder / f"{name}.png", optimize=True)


def _fail(_window: MainWindow, title: str, error: Exception) -> None:
    raise RuntimeError(title) from error


def _events() -> None:
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    QApplication.processEvents()
    time.sleep(0.005)
