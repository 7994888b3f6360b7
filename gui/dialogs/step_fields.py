"""What a STEP file states beside its geometry: where its zero is, who answers for it, whether it gets a certificate."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QSettings
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QStyle,
    QVBoxLayout,
    QWidget,
)

from geofit.data.columns import LARGEST
from geofit.data.site import Site
from geofit.data.stale import stale_warning
from geofit.data.title_block import TitleBlock
from geofit.gui.panels.marks import icon
from geofit.gui.theme import missing_chinese
from geofit.gui.translate import translated, user_language
from geofit.project.step_files import Signed

if TYPE_CHECKING:
    from geofit.cad.step_origin import Origin

__all__ = ["BodyStepDialog", "OriginField", "SignedFields"]

_AUTHOR, _ORGANISATION, _ORIGIN, _DATUM = "step/author", "step/organisation", "step/origin", "step/datum"


class OriginField(QWidget):
    """Map coordinates, local ones, or the project datum with its three coordinates."""

    def __init__(self, datum: tuple[float, float, float] | None = None) -> None:
        super().__init__()
        self.choice = QComboBox()
        self.choice.addItem(self.tr("map coordinates"), "map")
        self.choice.addItem(self.tr("local: a round place below the data"), "local")
        self.choice.addItem(self.tr("project datum"), "datum")
        self.choice.setToolTip(
            self.tr(
                "Origin of the file's coordinates. Local files state the offset, and reading them here restores map "
                "coordinates; other programs show the offset with the attributes."
            )
        )
        self.datum = QLineEdit()
        self.datum.setPlaceholderText(self.tr("easting, northing, elevation in m"))
        self.datum.setAccessibleName(self.tr("Project datum"))
        stored = str(QSettings().value(_DATUM, ""))
        self.datum.setText(stored if datum is None else ", ".join(format(value, ".15g") for value in datum))
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.choice)
        row.addWidget(self.datum, 1)
        self.setFocusProxy(self.choice)
        self.choice.currentIndexChanged.connect(self._show)
        self.choice.setCurrentIndex(max(0, self.choice.findData(str(QSettings().value(_ORIGIN, "map")))))
        self._show()

    @property
    def origin(self) -> Origin | None:
        """What was chosen, for :class:`geofit.project.step_files.Signed`; None while the datum is not three numbers."""
        chosen = str(self.choice.currentData())
        if chosen != "datum":
            return chosen
        try:
            place = tuple(float(part) for part in self.datum.text().replace(";", ",").split(","))
        except ValueError:
            return None
        return place if len(place) == 3 and all(abs(value) <= LARGEST for value in place) else None

    def store(self) -> None:
        """Remember the choice for the next file."""
        QSettings().setValue(_ORIGIN, self.choice.currentData())
        QSettings().setValue(_DATUM, self.datum.text().strip())

    def _show(self) -> None:
        self.datum.setVisible(self.choice.currentData() == "datum")


class SignedFields:
    """The fields of every STEP file, for a form: ``origin``, ``author``, ``organisation``, ``certificate``."""

    def __init__(self, dialog: QDialog, title: TitleBlock, datum: tuple[float, float, float] | None) -> None:
        self.origin = OriginField(datum)
        self.author, self.organisation = QLineEdit(), QLineEdit()
        about = dialog.tr("It is written in the head of the file and on the certificate.")
        for field, key, words in (
            (self.author, _AUTHOR, title.author), (self.organisation, _ORGANISATION, title.organisation)
        ):  # fmt: skip
            field.setText(words or str(QSettings().value(key, "")))
            field.setToolTip(about)
        self.certificate = QCheckBox(dialog.tr("&Certificate: one page of PDF with what was read back"))
        # A page in Chinese needs a font of it.
        self.no_page = user_language().code == "zh" and missing_chinese()
        self.certificate.setChecked(not self.no_page)
        self._dialog = dialog

    @property
    def widgets(self) -> tuple[QWidget, ...]:
        """The fields, in the order of the form."""
        return self.origin, self.author, self.organisation, self.certificate

    def add_to(self, form: QFormLayout) -> None:
        """Add the rows."""
        signed = QHBoxLayout()
        signed.addWidget(self.author, 1)
        organisation = QLabel(self._dialog.tr("&Organisation"))
        organisation.setBuddy(self.organisation)
        signed.addWidget(organisation)
        signed.addWidget(self.organisation, 1)
        author = QLabel(self._dialog.tr("&Author"))
        author.setBuddy(self.author)
        origin = QLabel(self._dialog.tr("O&rigin"))
        origin.setBuddy(self.origin.choice)
        form.addRow(origin, self.origin)
        form.addRow(author, signed)
        form.addRow("", self.certificate)

    def signed(self) -> Signed:
        """Return what the files state; the origin must be complete."""
        page = user_language().code if self.certificate.isChecked() else ""
        origin = self.origin.origin
        assert origin is not None
        return Signed(self.author.text().strip(), self.organisation.text().strip(), page, origin)

    def store(self) -> None:
        """Remember the entries for the next file."""
        self.origin.store()
        QSettings().setValue(_AUTHOR, self.author.text().strip())
        QSettings().setValue(_ORGANISATION, self.organisation.text().strip())


class BodyStepDialog(QDialog):
    """Asks what the STEP file of a body states; ``fields`` hold the answers, ``warning`` is shown of a stale body."""

    def __init__(self, name: str, site: Site, parent: QWidget | None = None, *, stale: bool = False) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Export body {name}").format(name=name))
        self.fields = SignedFields(self, site.title, site.datum)
        form = QFormLayout()
        self.fields.add_to(form)
        self.warning = QLabel(translated(stale_warning([name])))
        self.warning.setWordWrap(True)
        mark = QLabel()
        mark.setPixmap(icon("stale").pixmap(self.style().pixelMetric(QStyle.PixelMetric.PM_SmallIconSize)))
        warned = QHBoxLayout()
        warned.addWidget(mark)
        warned.addWidget(self.warning, 1)
        for widget in (mark, self.warning):
            widget.setVisible(stale)
        buttons = QDialogButtonBox()
        self.go = buttons.addButton(self.tr("&Write"), QDialogButtonBox.ButtonRole.AcceptRole)
        buttons.addButton(QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addLayout(warned)
        layout.addWidget(buttons)
        self.fields.certificate.setEnabled(not self.fields.no_page)
        for changed in (self.fields.origin.datum.textChanged, self.fields.origin.choice.currentIndexChanged):
            changed.connect(lambda *_: self.go.setEnabled(self.fields.origin.origin is not None))
        self.go.setEnabled(self.fields.origin.origin is not None)
        self.setMinimumWidth(560)

    def done(self, result: int) -> None:
        """Remember what was entered."""
        if result:
            self.fields.store()
        super().done(result)
