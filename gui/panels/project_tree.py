"""What the project holds and how the scene shows it: horizons with their verdicts, holes, adits, sections, reports."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QItemSelectionModel, QModelIndex, QPoint, QSize, QSortFilterProxyModel, Qt, QTimer, Signal
from PySide6.QtWidgets import (
    QAbstractItemView,
    QLineEdit,
    QMenu,
    QSlider,
    QVBoxLayout,
    QWidget,
    QWidgetAction,
)

from geofit.data.site import Site
from geofit.data.verdict import Verdict, verdict_of
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.lengths import in_lengths
from geofit.gui.panels.layer_form import LayerForm
from geofit.gui.panels.layer_rows import hang, layers_of_row, renew_row
from geofit.gui.panels.marks import icon, level_mark
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.row_view import RowView
from geofit.gui.panels.tables import natural
from geofit.gui.panels.tree_model import TreeModel, TreeRow
from geofit.gui.translate import translated
from geofit.gui.view3d.layers import Layers
from geofit.report.digits import metres
from geofit.report.style import horizon_colours

__all__ = ["ProjectTree", "TreeBody"]

_Given = tuple[Site | None, Mapping[str, HorizonFit], Container[str], Mapping[str, Verdict]]


@dataclass(frozen=True)
class TreeBody:
    """A body as the tree shows it: ``mark`` of its colour and verdict, whether it is drawn, how many contacts.

    ``stale``: it is older than its data.
    """

    name: str
    mark: str
    visible: bool
    count: int | None = None
    words: str = ""
    stale: bool = False


class ProjectTree(QWidget):
    """The tree of a site, with an eye and an opacity for all that the scene shows; a form has the rest of a layer.

    ``zoom_requested(key)`` asks to bring a layer into the picture.
    """

    horizon_chosen = Signal(str)
    patch_chosen = Signal(str, str)
    hole_chosen = Signal(str)
    section_chosen = Signal(str)
    report_chosen = Signal(str)
    menu_requested = Signal(str, str, QPoint)
    body_chosen = Signal(str)
    body_checked = Signal(str, bool)
    zoom_requested = Signal(str)

    def __init__(self, layers: Layers, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.layers, self.form = layers, LayerForm(layers)
        self.search = QLineEdit(clearButtonEnabled=True)
        self.search.setPlaceholderText(self.tr("Filter by name"))
        self.search.setAccessibleName(self.tr("Filter of the project tree"))
        content = QWidget()
        self.pages = Placeholder(content, self)
        # A view that is destroyed asks its model, and a filter its source: what was made first is destroyed first.
        self.view = RowView(content)
        self.shown = QSortFilterProxyModel(self)
        self.items = TreeModel(self._checked, self)
        self.shown.setSourceModel(self.items)
        self.shown.setRecursiveFilteringEnabled(True)
        self.shown.setAutoAcceptChildRows(True)
        self.shown.setFilterCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
        self.view.setModel(self.shown)
        self.view.setAccessibleName(self.tr("Project tree"))
        self.view.setUniformRowHeights(True)
        self.view.setIndentation(13)
        self.view.setIconSize(QSize(32, 16))
        self.view.setHeaderHidden(True)
        self.view.setMinimumHeight(160)
        self.view.opacity_asked.connect(self._ask_opacity)
        self.view.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.view.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.search.textChanged.connect(self._filter)
        # As in :class:`~geofit.gui.panels.tables.DataTable`.
        self._selection = QItemSelectionModel(self.shown, self.view)
        self.view.setSelectionModel(self._selection)
        self._selection.currentChanged.connect(self._tell)
        self.view.activated.connect(self._tell)
        self.view.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.view.customContextMenuRequested.connect(self._ask_menu)
        column = QVBoxLayout(content)
        column.setContentsMargins(8, 8, 8, 8)
        column.setSpacing(6)
        column.addWidget(self.search)
        # It is above the view, which was made first.
        self.setTabOrder(self.search, self.view)
        column.addWidget(self.view, 1)
        column.addWidget(self.form)
        self._later = QTimer(self, singleShot=True, interval=0)
        self._later.timeout.connect(lambda: self.show_site(*self._given))
        end = layers.subscribe(self._listen)
        self.destroyed.connect(lambda: end())
        self._reports: tuple[str, ...] = ()
        self._bodies: tuple[TreeBody, ...] = ()
        self._silent = False
        self._given: _Given = (None, {}, (), {})
        self.show_site(None, {}, ())

    def show_site(
        self,
        site: Site | None,
        surfaces: Mapping[str, HorizonFit],
        stale: Container[str] = (),
        verdicts: Mapping[str, Verdict] | None = None,
    ) -> None:
        """Show a site with its surfaces; names in ``stale`` have settings newer than their surface.

        ``verdicts`` has those of the surfaces where more is known than their own checks.
        """
        verdicts = verdicts or {}
        self._given = (site, surfaces, stale, verdicts)
        self._later.stop()
        if site is None:
            self.items.show([])
            self.form.show_layer(None)
            self.pages.say(self.tr("No site open: open a site or a project, or drop its files on the window."))
            return
        chosen, opened = self._chosen(), self._opened()
        self._silent = True
        groups = [
            self._group(
                "horizons",
                self.tr("Horizons"),
                [self._horizon(name, site, surfaces, stale, verdicts.get(name)) for name in site.horizons],
            ),
            self._group("bodies", self.tr("Bodies"), [self._body(body) for body in self._bodies]),
        ]
        for kind, title in (("borehole", self.tr("Boreholes")), ("adit", self.tr("Adits"))):
            holes = sorted((hole for hole in site.holes if hole.kind == kind), key=lambda hole: natural(hole.name))
            counts = _counts(site, "hole")
            mark = icon("hole" if kind == "borehole" else "adit")
            rows = [TreeRow(h.name, ("hole", h.name), counts.get(h.name, 0), mark) for h in holes]
            groups.append(self._group(kind, title, rows))
        counts = _counts(site, "section")
        sections = sorted(site.sections, key=lambda section: natural(section.name))
        rows = [TreeRow(s.name, ("section", s.name), counts.get(s.name, 0), icon("section")) for s in sections]
        groups.append(self._group("sections", self.tr("Sections"), rows))
        rows = [TreeRow(Path(path).name, ("report", path), None, icon("report"), path) for path in self._reports]
        groups.append(self._group("reports", self.tr("Reports"), rows))
        groups.insert(
            0, TreeRow(self.tr("Site", "ProjectTree"), ("group", "site"), head=True, rows=hang(self.layers, groups))
        )
        self.items.show([group for group in groups if group.rows])
        self._arrange(opened)
        self._go(chosen)
        self._silent = False
        self._show_form()
        self.pages.reveal()

    def show_reports(self, paths: Sequence[str]) -> None:
        """List the reports that were written."""
        self._reports = tuple(str(path) for path in paths)
        self.show_site(*self._given)

    def show_bodies(self, bodies: Sequence[TreeBody]) -> None:
        """List bodies below the horizons."""
        if tuple(bodies) != self._bodies:
            self._bodies = tuple(bodies)
            self.show_site(*self._given)

    def body_at(self, at: QPoint) -> str | None:
        """Return the body whose row lies under a place of the tree's view."""
        target = self._target(self.view.indexAt(at))
        return target[1] if target is not None and target[0] == "body" else None

    def choose_horizon(self, name: str) -> None:
        """Go to a horizon; nothing is emitted."""
        self._move(("horizon", name))

    def choose_hole(self, name: str) -> None:
        """Go to a hole; nothing is emitted."""
        self._move(("hole", name))

    def choose_layer(self, key: str) -> None:
        """Go to the row of a layer of the scene; nothing is emitted."""
        self._move(self.row(key).target)

    def row(self, key: str) -> TreeRow:
        """Return the row of a layer of the scene; KeyError where there is none."""
        if self._later.isActive():
            self.show_site(*self._given)
        for row in self.items.all():
            if row.layer == key:
                return row
        raise KeyError(key)

    def menu_for(self, key: str) -> QMenu:
        """Return the menu of a layer of the scene."""
        menu = QMenu(self)
        menu.addAction(self.tr("Zoom to")).triggered.connect(lambda: self.zoom_requested.emit(key))
        menu.addAction(self.tr("Only this")).triggered.connect(lambda: self.layers.only(key))
        menu.addAction(self.tr("Show all")).triggered.connect(self._show_all)
        return menu

    def opacity_menu(self, key: str) -> QMenu:
        """Return a slider for the opacity of a layer."""
        menu, slider = QMenu(self), QSlider(Qt.Orientation.Horizontal)
        slider.setRange(5, 100)
        slider.setPageStep(10)
        slider.setMinimumWidth(150)
        slider.setAccessibleName(self.tr("Opacity"))
        slider.setValue(round(100 * self.layers[key].opacity))
        slider.valueChanged.connect(lambda value: self.layers.change(key, opacity=value / 100))
        action = QWidgetAction(menu)
        action.setDefaultWidget(slider)
        menu.addAction(action)
        return menu

    # From the layers -----------------------------------------------------------------------------------------

    def _listen(self, what: str, key: str) -> None:
        """Follow what the scene shows: a change of a row at once, other rows once the event is over."""
        if what != "changed":
            self._later.start()
            return
        layer = self.layers[key]
        for row in self.items.all():
            if row.layer == key or row.target == ("horizon", layer.horizon):
                renew_row(row, self.layers)
                self.items.renew(row)
        self._show_form()

    def _show_form(self) -> None:
        """Show how the layer of the chosen row is drawn; a patch has that of its surface."""
        row = self.items.row_of(self.shown.mapToSource(self.view.currentIndex()))
        key = "" if row is None else row.layer
        if row is not None and row.target[0] == "patch":
            key = f"surface:{row.target[1].partition(chr(10))[0]}"
        self.form.show_layer(self.layers[key] if key in self.layers else None)  # noqa: SIM401 - no mapping

    def _show_all(self) -> None:
        for layer in self.layers:
            self.layers.change(layer.key, visible=True)

    def _ask_opacity(self, index: QModelIndex) -> None:
        row = self.items.row_of(self.shown.mapToSource(index))
        if row is not None and row.layer in self.layers:
            box = self.view.visualRect(index)
            self._pop_up(self.opacity_menu(row.layer), self.view.viewport().mapToGlobal(box.bottomLeft()))

    def _pop_up(self, menu: QMenu, at: QPoint) -> None:
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        menu.popup(at)

    # Rows ----------------------------------------------------------------------------------------------------

    def _horizon(
        self,
        name: str,
        site: Site,
        surfaces: Mapping[str, HorizonFit],
        stale: Container[str],
        verdict: Verdict | None,
    ) -> TreeRow:
        surface = surfaces.get(name)
        count, colour = len(site.horizons[name]), horizon_colours(site.horizons, site.blocks)[name]
        if surface is None or surface.accuracy is None:
            words = self.tr("{name}: not fitted yet").format(name=name)
            return TreeRow(name, ("horizon", name), count, icon(f"horizon:{colour}"), words)
        a, old = surface.accuracy, name in stale
        judged = verdict or verdict_of(a)
        words = self.tr("{name}: {verdict}; patches: {patches}, points: {n}").format(
            name=name, verdict=translated(judged.word), patches=len(surface.patches), n=a.n
        )
        words = "\n".join(
            (words, *(f"{translated(lamp.title)}: {in_lengths(translated(lamp.text))}" for lamp in judged.lamps))
        )
        aloud = f"{name}, {translated(judged.word)}"
        if old:
            # The mark and the slope of the letters show it: the name needs the room.
            older = self.tr("Older than its data or settings: press Fit")
            words, aloud = f"{words}\n{older}", f"{aloud}, {older}"
        mark = icon(f"horizon:{colour}+{'stale' if old else level_mark(judged.level)}")
        row = TreeRow(name, ("horizon", name), count, mark, words, aloud, italic=old)
        for patch in surface.patches:
            group = a.by_patch.get(patch.name)
            rows, columns = patch.control.shape[:2]
            about = self.tr("Patch {name}: {rows} × {columns} control points, largest |d| {most} m").format(
                name=translated(patch.name), rows=rows, columns=columns, most=metres(group.max_abs if group else 0.0)
            )
            about = in_lengths(about)
            target = ("patch", f"{name}\n{patch.name}")
            points = group.n if group else 0
            row.rows.append(TreeRow(translated(patch.name), target, points, icon(f"patch:{colour}"), about))
        return row

    def _body(self, body: TreeBody) -> TreeRow:
        aloud = body.words.replace("\n", ", ") if body.stale else ""
        mark, stale = icon(body.mark), body.stale
        return TreeRow(
            body.name, ("body", body.name), body.count, mark, body.words, aloud, checked=body.visible, italic=stale
        )

    def _checked(self, row: TreeRow, on: bool) -> None:
        if row.target[0] == "body":
            self.body_checked.emit(row.target[1], on)
            return
        for key in tuple(layers_of_row(row, self.layers, opened=on)):
            self.layers.change(key, visible=on)

    def _group(self, key: str, title: str, rows: list[TreeRow]) -> TreeRow:
        words = self.tr("{title} ({n})").format(title=title, n=len(rows))
        return TreeRow(words, ("group", key), head=True, rows=rows)

    def _filter(self, text: str) -> None:
        self.shown.setFilterFixedString(text.strip())
        if text.strip():
            self.view.expandAll()

    def _arrange(self, opened: dict[tuple[str, str], bool]) -> None:
        self.view.lay_out()
        for row in self.items.all():
            # A first look shows the horizons, and the rest only where it is short.
            small = row.head and (row.target[1] in ("horizons", "bodies") or len(row.rows) <= 6)
            if row.rows:
                self.view.setExpanded(self._index(row), opened.get(row.target, small))

    def _opened(self) -> dict[tuple[str, str], bool]:
        """Return which rows a person sees the rows below of."""
        return {row.target: self.view.isExpanded(self._index(row)) for row in self.items.all() if row.rows}

    def _index(self, row: TreeRow) -> QModelIndex:
        return self.shown.mapFromSource(self.items.index_of(row))

    def _chosen(self) -> tuple[str, str] | None:
        return self._target(self.view.currentIndex())

    def _target(self, index: QModelIndex) -> tuple[str, str] | None:
        row = self.items.row_of(self.shown.mapToSource(index))
        return None if row is None else row.target

    def _go(self, target: tuple[str, str] | None) -> None:
        for row in self.items.all():
            if row.target == target and (row.layer or not row.head):
                self.view.setCurrentIndex(self._index(row))
                self.view.scrollTo(self._index(row))
                return

    def _move(self, target: tuple[str, str]) -> None:
        """Go to a row without telling others; below the tree is how its layer is drawn."""
        self._silent = True
        self._go(target)
        self._silent = False
        self._show_form()

    def _ask_menu(self, at: QPoint) -> None:
        target = self._target(self.view.indexAt(at))
        if target is not None:
            kind, name = target
            row = self.items.row_of(self.shown.mapToSource(self.view.indexAt(at)))
            if kind in ("layer", "group"):
                if row is not None and row.layer in self.layers:
                    self._pop_up(self.menu_for(row.layer), self.view.viewport().mapToGlobal(at))
                return
            if kind == "patch":
                kind, name = "horizon", name.split("\n", 1)[0]
            self.menu_requested.emit(kind, name, self.view.viewport().mapToGlobal(at))

    def _tell(self, index: QModelIndex) -> None:
        target = self._target(index)
        if self._silent or target is None:
            return
        self._show_form()
        kind, name = target
        if kind == "horizon":
            self.horizon_chosen.emit(name)
        elif kind == "patch":
            self.patch_chosen.emit(*name.split("\n", 1))
        elif kind == "hole":
            self.hole_chosen.emit(name)
        elif kind == "section":
            self.section_chosen.emit(name)
        elif kind == "body":
            self.body_chosen.emit(name)
        elif kind == "report":
            self.report_chosen.emit(name)


def _counts(site: Site, column: str) -> dict[str, int]:
    """Return how many points of all horizons come from each hole or section."""
    counts: dict[str, int] = {}
    for points in site.horizons.values():
        for name in getattr(points, column).tolist():
            counts[name] = counts.get(name, 0) + 1
    return counts
