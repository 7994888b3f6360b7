"""What the project holds: horizons with their verdicts, holes, adits, sections and reports."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QModelIndex, QPoint, QSortFilterProxyModel, Qt, Signal
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QLineEdit, QTreeView, QVBoxLayout, QWidget

from geofit.data.site import Site
from geofit.data.verdict import Verdict, verdict_of
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.lengths import in_lengths
from geofit.gui.panels.marks import icon, level_mark
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.tables import natural
from geofit.gui.panels.tree_model import TreeModel, TreeRow
from geofit.gui.translate import translated
from geofit.report.digits import metres
from geofit.report.style import horizon_colours

__all__ = ["ProjectTree", "TreeBody"]

_Given = tuple[Site | None, Mapping[str, HorizonFit], Container[str], Mapping[str, Verdict]]


@dataclass(frozen=True)
class TreeBody:
    """A body as the tree shows it: ``mark`` of its colour and verdict, whether it is drawn, how many contacts."""

    name: str
    mark: str
    visible: bool
    count: int | None = None
    words: str = ""


class ProjectTree(QWidget):
    """The tree of a site. What it shows is chosen here; what the scene shows is the scene list's business."""

    horizon_chosen = Signal(str)
    patch_chosen = Signal(str, str)
    hole_chosen = Signal(str)
    section_chosen = Signal(str)
    report_chosen = Signal(str)
    menu_requested = Signal(str, str, QPoint)
    body_chosen = Signal(str)
    body_checked = Signal(str, bool)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.search = QLineEdit(clearButtonEnabled=True)
        self.search.setPlaceholderText(self.tr("Filter by name"))
        self.search.setAccessibleName(self.tr("Filter of the project tree"))
        content = QWidget()
        self.pages = Placeholder(content)
        self.setLayout(self.pages)
        # A view that is destroyed asks its model, and a filter its source: what was made first is destroyed first.
        self.view = QTreeView(content)
        self.shown = QSortFilterProxyModel(self)
        self.items = TreeModel((self.tr("Project"), self.tr("Points")), self._checked, self)
        self.shown.setSourceModel(self.items)
        self.shown.setRecursiveFilteringEnabled(True)
        self.shown.setAutoAcceptChildRows(True)
        self.shown.setFilterCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
        self.view.setModel(self.shown)
        self.view.setAccessibleName(self.tr("Project tree"))
        self.view.setUniformRowHeights(True)
        self.view.setIndentation(16)
        self.view.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.view.setTextElideMode(Qt.TextElideMode.ElideRight)
        self.search.textChanged.connect(self._filter)
        self.view.selectionModel().currentChanged.connect(self._tell)
        self.view.activated.connect(self._tell)
        self.view.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.view.customContextMenuRequested.connect(self._ask_menu)
        column = QVBoxLayout(content)
        column.setContentsMargins(8, 8, 8, 8)
        column.setSpacing(6)
        column.addWidget(self.search)
        column.addWidget(self.view, 1)
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
        if site is None:
            self.items.show([])
            self.pages.say(self.tr("No site open: open a site or a project, or drop its files on the window."))
            return
        chosen, folded = self._chosen(), self._folded()
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
        self.items.show([group for group in groups if group.rows])
        self._arrange(folded)
        self._go(chosen)
        self._silent = False
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
        self._silent = True
        self._go(("horizon", name))
        self._silent = False

    def choose_hole(self, name: str) -> None:
        """Go to a hole; nothing is emitted."""
        self._silent = True
        self._go(("hole", name))
        self._silent = False

    def _horizon(
        self,
        name: str,
        site: Site,
        surfaces: Mapping[str, HorizonFit],
        stale: Container[str],
        verdict: Verdict | None,
    ) -> TreeRow:
        surface = surfaces.get(name)
        count, colour = len(site.horizons[name]), horizon_colours(site.horizons)[name]
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
        title = name
        if old:
            title = self.tr("{name} (stale)").format(name=name)
            words += "\n" + self.tr("Older than the settings: press Fit")
        mark, aloud = icon("stale" if old else level_mark(judged.level)), f"{name}, {translated(judged.word)}"
        row = TreeRow(title, ("horizon", name), count, mark, words, aloud, italic=old)
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
        return TreeRow(body.name, ("body", body.name), body.count, icon(body.mark), body.words, checked=body.visible)

    def _checked(self, row: TreeRow, on: bool) -> None:
        self.body_checked.emit(row.target[1], on)

    def _group(self, key: str, title: str, rows: list[TreeRow]) -> TreeRow:
        words = self.tr("{title} ({n})").format(title=title, n=len(rows))
        return TreeRow(words, ("group", key), head=True, rows=rows)

    def _filter(self, text: str) -> None:
        self.shown.setFilterFixedString(text.strip())
        if text.strip():
            self.view.expandAll()

    def _arrange(self, folded: set[object] | None) -> None:
        header = self.view.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        header.setSectionResizeMode(1, QHeaderView.ResizeMode.ResizeToContents)
        for head in self.items.rows:
            # A first look shows the horizons, and the rest only where it is short.
            small = head.target[1] in ("horizons", "bodies") or len(head.rows) <= 6
            opened = small if folded is None else head.target not in folded
            self.view.setExpanded(self._index(head), opened)

    def _folded(self) -> set[object] | None:
        if not self.items.rows:
            return None
        return {head.target for head in self.items.rows if not self.view.isExpanded(self._index(head))}

    def _index(self, row: TreeRow) -> QModelIndex:
        return self.shown.mapFromSource(self.items.index_of(row))

    def _chosen(self) -> tuple[str, str] | None:
        return self._target(self.view.currentIndex())

    def _target(self, index: QModelIndex) -> tuple[str, str] | None:
        row = self.items.row_of(self.shown.mapToSource(index))
        return None if row is None else row.target

    def _go(self, target: tuple[str, str] | None) -> None:
        for row in self.items.all():
            if row.target == target and not row.head:
                self.view.setCurrentIndex(self._index(row))
                self.view.scrollTo(self._index(row))
                return

    def _ask_menu(self, at: QPoint) -> None:
        target = self._target(self.view.indexAt(at))
        if target is not None:
            kind, name = target
            if kind == "patch":
                kind, name = "horizon", name.split("\n", 1)[0]
            self.menu_requested.emit(kind, name, self.view.viewport().mapToGlobal(at))

    def _tell(self, index: QModelIndex) -> None:
        target = self._target(index)
        if self._silent or target is None:
            return
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
