"""The actions of the main window: their words, keys and icons. What they do is connected where it is done."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication, QObject
from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMainWindow

from geofit.gui.icons import palette_icon
from geofit.gui.language import LANGUAGES
from geofit.gui.translate import bare

__all__ = ["EXAGGERATIONS", "Actions"]

EXAGGERATIONS = (1.0, 2.0, 3.0, 5.0, 10.0)
_Key = QKeySequence.StandardKey
# QT_TRANSLATE_NOOP is typed as giving any object.
_Spec = tuple[Any, Any, Any, str]

#: name: text, key, tooltip, icon. Texts are translated where the actions are made.
_PLAIN: dict[str, _Spec] = {
    "new": (QT_TRANSLATE_NOOP("Actions", "&New from files…"), _Key.New,
            QT_TRANSLATE_NOOP("Actions", "Import tables, drawings and grids as a new site"), "import"),
    "open": (QT_TRANSLATE_NOOP("Actions", "&Open…"), _Key.Open,
             QT_TRANSLATE_NOOP("Actions", "Open a project (*.geofit) or a site file (site.toml)"), "open"),
    "sample": (QT_TRANSLATE_NOOP("Actions", "Open sam&ple site"), None,
               QT_TRANSLATE_NOOP("Actions", "A fictional dam site with five horizons, to try things out"), ""),
    "add_data": (QT_TRANSLATE_NOOP("Actions", "A&dd data…"), "Ctrl+Shift+A",
                 QT_TRANSLATE_NOOP("Actions", "Add files to the open site: new holes, picks, sections"), ""),
    "reload": (QT_TRANSLATE_NOOP("Actions", "Re&load changed files"), "Ctrl+Shift+R",
               QT_TRANSLATE_NOOP("Actions", "Read the site's files again; your work is kept"), ""),
    "save": (QT_TRANSLATE_NOOP("Actions", "&Save"), _Key.Save,
             QT_TRANSLATE_NOOP("Actions", "Save the project with its surfaces"), "save"),
    "save_as": (QT_TRANSLATE_NOOP("Actions", "Save &as…"), _Key.SaveAs, "", ""),
    "export_step": (QT_TRANSLATE_NOOP("Actions", "&Export STEP…"), "Ctrl+E",
                    QT_TRANSLATE_NOOP("Actions", "Write STEP for CAD, and read the file back"), "export"),
    "export_other": (QT_TRANSLATE_NOOP("Actions", "Export other &formats…"), "Ctrl+Shift+E", "", ""),
    "report": (QT_TRANSLATE_NOOP("Actions", "Repor&t…"), "Ctrl+R",
               QT_TRANSLATE_NOOP("Actions", "Accuracy report as HTML or PDF, in English or Chinese"), "report"),
    "section_sheet": (QT_TRANSLATE_NOOP("Actions", "Section s&heet…"), None,
                      QT_TRANSLATE_NOOP("Actions", "Sections to scale with a title block, as PDF, SVG or DXF"), ""),
    "plan_sheet": (QT_TRANSLATE_NOOP("Actions", "Conto&ur plan…"), None,
                   QT_TRANSLATE_NOOP("Actions", "Contours to scale with a title block, as PDF, SVG or DXF"), ""),
    "screenshot": (QT_TRANSLATE_NOOP("Actions", "S&creenshot…"), "Ctrl+Shift+P",
                   QT_TRANSLATE_NOOP("Actions", "Picture of the 3D view at print size"), "screenshot"),
    "issues": (QT_TRANSLATE_NOOP("Actions", "Import pro&blems…"), None,
               QT_TRANSLATE_NOOP("Actions", "Rows that were not used, warnings and notes of the import"), ""),
    "close": (QT_TRANSLATE_NOOP("Actions", "Close s&ite"), _Key.Close, "", ""),
    "quit": (QT_TRANSLATE_NOOP("Actions", "&Quit"), "Ctrl+Q", "", ""),
    "steps": (QT_TRANSLATE_NOOP("Actions", "All &steps…"), "Ctrl+Alt+Z",
              QT_TRANSLATE_NOOP("Actions", "What was done in this session; go back or forward to any step"), ""),
    "rename": (QT_TRANSLATE_NOOP("Actions", "Re&name site…"), None, "", ""),
    "preferences": (QT_TRANSLATE_NOOP("Actions", "&Preferences…"), "Ctrl+,", "", ""),
    "home": (QT_TRANSLATE_NOOP("Actions", "Show &all"), "Home",
             QT_TRANSLATE_NOOP("Actions", "Move the camera so that everything is seen"), "home"),
    "top": (QT_TRANSLATE_NOOP("Actions", "From the &top"), "7", "", ""),
    "north": (QT_TRANSLATE_NOOP("Actions", "Towards &north"), "1", "", ""),
    "south": (QT_TRANSLATE_NOOP("Actions", "Towards &south"), "Ctrl+1", "", ""),
    "east": (QT_TRANSLATE_NOOP("Actions", "Towards &east"), "3", "", ""),
    "west": (QT_TRANSLATE_NOOP("Actions", "Towards &west"), "Ctrl+3", "", ""),
    "iso": (QT_TRANSLATE_NOOP("Actions", "F&rom a corner"), "0", "", ""),
    "fold": (QT_TRANSLATE_NOOP("Actions", "Fold or unfold the panels &below"), "Ctrl+J",
             QT_TRANSLATE_NOOP("Actions", "Hide the panels below the 3D view to enlarge it, or bring them back"), ""),
    "next_panel": (QT_TRANSLATE_NOOP("Actions", "&Next panel"), "Ctrl+Tab",
                   QT_TRANSLATE_NOOP("Actions", "Move the keyboard focus to the next panel"), ""),
    "previous_panel": (QT_TRANSLATE_NOOP("Actions", "Pre&vious panel"), "Ctrl+Shift+Tab",
                       QT_TRANSLATE_NOOP("Actions", "Move the keyboard focus to the previous panel"), ""),
    "reset_layout": (QT_TRANSLATE_NOOP("Actions", "&Reset panels"), None,
                     QT_TRANSLATE_NOOP("Actions", "Put every panel back where it was at first"), ""),
    "fit": (QT_TRANSLATE_NOOP("Actions", "&Fit"), "F5",
            QT_TRANSLATE_NOOP("Actions", "Fit the chosen horizon with its settings"), "fit"),
    "fit_all": (QT_TRANSLATE_NOOP("Actions", "Fit &all"), "Shift+F5",
                QT_TRANSLATE_NOOP("Actions", "Fit horizons with no surface or an outdated one"), "fit_all"),
    "examine": (QT_TRANSLATE_NOOP("Actions", "&Examine away from the data"), "F6",
                QT_TRANSLATE_NOOP("Actions", "Cross-validate: find the prediction error away from the data"),
                "examine"),
    "check_order": (QT_TRANSLATE_NOOP("Actions", "Check the &order"), "F7",
                    QT_TRANSLATE_NOOP("Actions", "Whether each horizon stays above the next one"), ""),
    "order": (QT_TRANSLATE_NOOP("Actions", "O&rder of the horizons…"), None,
              QT_TRANSLATE_NOOP("Actions", "Say which horizon lies above which"), ""),
    "separate": (QT_TRANSLATE_NOOP("Actions", "&Separate horizons…"), "Ctrl+F7",
               QT_TRANSLATE_NOOP("Actions", "Separate horizons where they cross; points met exactly stay"), ""),
    "build_horizon": (QT_TRANSLATE_NOOP("Actions", "&Build from lithology…"), "Ctrl+B",
                      QT_TRANSLATE_NOOP("Actions", "A horizon from logged codes: group, top or base, thin beds"), ""),
    "compare_fits": (QT_TRANSLATE_NOOP("Actions", "&Compare fits…"), "Ctrl+Shift+F",
                     QT_TRANSLATE_NOOP("Actions", "Two fits of the chosen horizon side by side, with one camera"), ""),
    "worst": (QT_TRANSLATE_NOOP("Actions", "Go to the &worst point"), "F8", "", ""),
    "exclude": (QT_TRANSLATE_NOOP("Actions", "E&xclude or include the chosen row"), "Ctrl+D", "", ""),
    "stop": (QT_TRANSLATE_NOOP("Actions", "S&top the task"), "Esc", "", "cancel"),
    "rock_volume": (QT_TRANSLATE_NOOP("Actions", "&Rock volume…"), None,
                    QT_TRANSLATE_NOOP("Actions", "Pores, throats and permeability of a scanned rock core"), ""),
    "survey": (QT_TRANSLATE_NOOP("Actions", "Survey of &passages…"), None,
               QT_TRANSLATE_NOOP("Actions", "Centre line, loops, walls and volume of a cave, adit or tunnel"), ""),
    "help": (QT_TRANSLATE_NOOP("Actions", "&Help on this panel"), "F1",
             QT_TRANSLATE_NOOP("Actions", "What explains the panel that has the keyboard focus"), ""),
    "tutorial": (QT_TRANSLATE_NOOP("Actions", "&Tutorial"), None, "", ""),
    "shortcuts": (QT_TRANSLATE_NOOP("Actions", "&Keyboard shortcuts"), "Ctrl+/", "", ""),
    "system_report": (QT_TRANSLATE_NOOP("Actions", "&System report"), None, "", ""),
    "about": (QT_TRANSLATE_NOOP("Actions", "&About geofit"), None, "", ""),
}  # fmt: skip
_SWITCHES: dict[str, _Spec] = {
    "orthographic": (QT_TRANSLATE_NOOP("Actions", "&Orthographic"), "5",
                     QT_TRANSLATE_NOOP("Actions", "Parallel lines stay parallel: for measuring"), ""),
    "clip": (QT_TRANSLATE_NOOP("Actions", "&Clip box"), "C",
             QT_TRANSLATE_NOOP("Actions", "Show only what lies within a box that can be dragged"), "clip"),
    "faded": (QT_TRANSLATE_NOOP("Actions", "&Fade above ground and beyond the data"), "G",
              QT_TRANSLATE_NOOP("Actions", "Dashed or translucent above the ground and beyond the points"), ""),
    "control_points": (QT_TRANSLATE_NOOP("Actions", "Control po&ints"), "P",
                       QT_TRANSLATE_NOOP("Actions", "Show the control points of the chosen horizon"), ""),
    "seams": (QT_TRANSLATE_NOOP("Actions", "Sea&ms"), "E",
              QT_TRANSLATE_NOOP("Actions", "Colour the seams of the chosen horizon by gap and angle"), ""),
    "measure": (QT_TRANSLATE_NOOP("Actions", "&Measure"), "M",
                QT_TRANSLATE_NOOP("Actions", "Click two points: distance, difference in height, dip"), "measure"),
    "section": (QT_TRANSLATE_NOOP("Actions", "&Section"), "S",
                QT_TRANSLATE_NOOP("Actions", "Cut the horizons along a line that can be dragged"), "section"),
}  # fmt: skip


class Actions(QObject):
    """Every action of the window by its name: ``actions["fit"]``."""

    def __init__(self, window: QMainWindow) -> None:
        super().__init__(window)
        self._by_name: dict[str, QAction] = {}
        for table, checkable in ((_PLAIN, False), (_SWITCHES, True)):
            for name, (text, key, tip, drawing) in table.items():
                self._by_name[name] = _action(window, name, text, key, tip, drawing, checkable)
        self["quit"].setMenuRole(QAction.MenuRole.QuitRole)
        self["preferences"].setMenuRole(QAction.MenuRole.PreferencesRole)
        self["about"].setMenuRole(QAction.MenuRole.AboutRole)
        self.exaggerations = _choices(window, [(f"{f:g} ×", f) for f in EXAGGERATIONS], 1.0)
        themes = {
            "system": self.tr("As the system"),
            "light": self.tr("Light"),
            "dark": self.tr("Dark"),
        }
        self.themes = _choices(window, [(text, name) for name, text in themes.items()], "system")
        self.languages = _choices(window, [(text, code) for code, text in LANGUAGES.items()], "en")

    def __getitem__(self, name: str) -> QAction:
        return self._by_name[name]

    def all(self) -> dict[str, QAction]:
        """Return every action by its name."""
        return dict(self._by_name)

    def draw_icons(self) -> None:
        """Draw the icons anew, in the colours of the present theme."""
        for name, (*_, drawing) in (_PLAIN | _SWITCHES).items():
            if drawing:
                self[name].setIcon(palette_icon(drawing))


def _action(window: QMainWindow, name: str, text: str, key: Any, tip: str, drawing: str, checkable: bool) -> QAction:
    action = QAction(QCoreApplication.translate("Actions", text), window)
    action.setObjectName(name)
    action.setIconText(bare(action.text()))
    action.setCheckable(checkable)
    if key is not None:
        action.setShortcut(QKeySequence(key))
    words = QCoreApplication.translate("Actions", tip) if tip else bare(action.text())
    keys = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
    action.setToolTip(f"{words} ({keys})" if keys else words)
    action.setStatusTip(words)
    if drawing:
        action.setIcon(palette_icon(drawing))
    window.addAction(action)
    return action


def _choices(window: QMainWindow, entries: list[tuple[str, object]], chosen: object) -> QActionGroup:
    """Return a group of which one is always checked; each action's data is its value."""
    group = QActionGroup(window)
    for text, value in entries:
        action = group.addAction(text)
        action.setCheckable(True)
        action.setData(value)
        action.setChecked(value == chosen)
    return group
