"""Asks where files shall be saved; whoever writes them has agreed to replace what has these names already."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from PySide6.QtWidgets import QFileDialog, QMessageBox, QWidget

from geofit.data.messages import Untranslated, message, some_of
from geofit.gui.translate import translated

__all__ = ["ask_save_file", "may_replace"]

#: Files that a question names; of more it gives the number.
NAMED = 4


def ask_save_file(parent: QWidget, title: str, start: str | Path, kinds: str) -> tuple[Path, str] | None:
    """Ask for a file to write.

    Parameters
    ----------
    parent : QWidget
        The window that asks.
    title : str
        What the dialog is called.
    start : str or Path
        The file that is proposed.
    kinds : str
        Kinds of files with their endings, as Qt takes them: ``"STEP files (*.step *.stp);;IGES files (*.igs)"``.

    Returns
    -------
    (Path, str) or None
        The file and its kind; None if no file is to be written. A name without an ending of ``kinds`` gets the first
        ending of the kind that was chosen.
    """
    path, kind = Path(start), ""
    while True:
        # The system's own question comes before the ending is added: it would be about another file.
        name, kind = QFileDialog.getSaveFileName(
            parent, title, str(path), kinds, kind, options=QFileDialog.Option.DontConfirmOverwrite
        )
        if not name:
            return None
        path, kind = _completed(name, kind, kinds)
        if may_replace([path], title, parent):
            return path, kind


def _completed(name: str, chosen: str, kinds: str) -> tuple[Path, str]:
    """Return the name with an ending, and the kind that the ending represents; the chosen kind goes first."""
    endings = {kind: re.findall(r"\*(\.\w+)", kind) for kind in kinds.split(";;")}
    chosen = chosen if chosen in endings else next(iter(endings))
    for kind in (chosen, *endings):
        for ending in endings[kind]:
            if name.casefold().endswith(ending):
                return Path(name[: -len(ending)] + ending), kind
    return Path(name + endings[chosen][0]), chosen


def may_replace(files: Iterable[Path], title: str, parent: QWidget) -> bool:
    """Ask whether the files that exist may be replaced, if there are any; True if nothing is lost unasked."""
    names = [Untranslated(file.name) for file in files if file.exists()]
    if not names:
        return True
    text = message("gui.replace-file", "{name} already exists. Replace it?", name=names[0])
    if len(names) > 1:
        text = message("gui.replace-files", "{names} already exist. Replace them?", names=some_of(names, NAMED))
    box = QMessageBox(QMessageBox.Icon.Warning, title, translated(text), parent=parent)
    box.setStandardButtons(QMessageBox.StandardButton.Yes | QMessageBox.StandardButton.No)
    box.setDefaultButton(QMessageBox.StandardButton.No)
    return box.exec() == QMessageBox.StandardButton.Yes
