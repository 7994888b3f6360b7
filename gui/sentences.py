"""What the windows' own model and log say (``said``, and lines for logging), for the translators."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

__all__ = ["SENTENCES"]

_STEPS = (
    QT_TRANSLATE_NOOP("Said", "Settings of {name}"),
    QT_TRANSLATE_NOOP("Said", "Core of {name}"),
    QT_TRANSLATE_NOOP("Said", "Exclude {file} row {row} from {name}"),
    QT_TRANSLATE_NOOP("Said", "Include {file} row {row} in {name}"),
    QT_TRANSLATE_NOOP("Said", "Fit {name}"),
    QT_TRANSLATE_NOOP("Said", "Part {name} at {faults}"),
    QT_TRANSLATE_NOOP("Said", "Move control point {i}, {j} of {patch} by {dz:+.3f} m ({name})"),
    QT_TRANSLATE_NOOP("Said", "Weight {weight:g} for control point {i}, {j} of {patch} ({name})"),
    QT_TRANSLATE_NOOP("Said", "Pull {name} to point {number}"),
    QT_TRANSLATE_NOOP("Said", "Push apart {names}"),
    QT_TRANSLATE_NOOP("Said", "Order of the horizons"),
    QT_TRANSLATE_NOOP("Said", "Rename the site to {name}"),
)

_REFUSALS = (
    QT_TRANSLATE_NOOP("Said", "The site has no horizon '{name}'. It has {names}."),
    QT_TRANSLATE_NOOP("Said", "'{step}' was not done yet and cannot be undone."),
    QT_TRANSLATE_NOOP("Said", "{file} row {row} is excluded from '{name}' already."),
    QT_TRANSLATE_NOOP("Said", "{file} row {row} is not excluded from '{name}'."),
    QT_TRANSLATE_NOOP("Said", "'{name}' has no surface to adjust. Fit it first."),
    QT_TRANSLATE_NOOP("Said", "'{name}' has no surface to examine. Fit it first."),
    QT_TRANSLATE_NOOP("Said", "'{name}' has no surface that could be moved. Fit it first."),
    QT_TRANSLATE_NOOP(
        "Said", "'{name}' was read from a file, and its data have changed since. Fit it again, then adjust."
    ),
    QT_TRANSLATE_NOOP("Said", "The surface changed while it was adjusted. Adjust it once more."),
    QT_TRANSLATE_NOOP("Said", "The order must name each horizon once: {names}."),
    QT_TRANSLATE_NOOP("Said", "The site's name is empty. Give it a word."),
    QT_TRANSLATE_NOOP(
        "Said",
        "A scale of {scale:g} makes a picture of {width} × {height} pixels; give one above 0 and below {most:.1f}.",
    ),
    QT_TRANSLATE_NOOP(
        "Said",
        "The process that did the work ended by itself (exit code {code}). Memory may have run out: close other "
        "programs and try again.",
    ),
)

_LOG = (
    QT_TRANSLATE_NOOP("Said", "Opened %s: %d horizons, %d holes, %d rows not used"),
    QT_TRANSLATE_NOOP("Said", "Saved %s"),
    QT_TRANSLATE_NOOP("Said", "Wrote %s"),
    QT_TRANSLATE_NOOP("Said", "Stopped: %s"),
    QT_TRANSLATE_NOOP("Said", "%s failed"),
    QT_TRANSLATE_NOOP("Said", "%s: %s"),
    QT_TRANSLATE_NOOP("Said", "%s: %s since the project was saved."),
    QT_TRANSLATE_NOOP("Said", "missing"),
    QT_TRANSLATE_NOOP("Said", "changed"),
    QT_TRANSLATE_NOOP("Said", "%s and %s cross at %d places"),
    QT_TRANSLATE_NOOP("Said", "The data of %s have changed since: its surface cannot be made again as it was. Fit it."),
    QT_TRANSLATE_NOOP("Said", "The journal of a session cannot be read (%s); it is kept as %s"),
    QT_TRANSLATE_NOOP("Said", "There is no journal, so that a crash would lose unsaved work: %s"),
    QT_TRANSLATE_NOOP("Said", "The journal cannot be written any more, so that a crash would lose unsaved work: %s"),
    QT_TRANSLATE_NOOP(
        "Said",
        "No font on this machine has Chinese characters: they are shown as boxes. Install one (Debian and Ubuntu: "
        "apt-get install fonts-noto-cjk) and start again.",
    ),
)

SENTENCES = tuple(str(text) for text in (*_STEPS, *_REFUSALS, *_LOG))
