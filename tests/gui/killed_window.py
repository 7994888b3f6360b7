"""The whole application, working by itself until somebody kills it; each step that is done is told on stdout."""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path

from PySide6.QtCore import QTimer

from geofit.data.settings import FitSettings
from geofit.gui.desktop import Desktop
from geofit.project.commands import RenameSite, SetSettings
from geofit.project.state import State


def digest(state: State) -> str:
    """Return a short name of a state."""
    return hashlib.sha256(json.dumps(state.to_data(), sort_keys=True).encode()).hexdigest()[:16]


def main() -> None:
    desktop = Desktop()
    window, session = desktop.window, desktop.session
    window.show()
    window.files.open(Path(sys.argv[1]))
    count = 0

    def step() -> None:
        nonlocal count
        if window.activity.busy or not session.document.horizons:
            return
        count += 1
        name = session.document.horizons[0]
        if count == 1:
            session.push(RenameSite("step 1"))
        elif count % 3 == 0:
            session.stack.undo()
        elif count % 3 == 1:
            session.push(SetSettings(name, FitSettings(epsilon=1.0 / count)))
        else:
            session.push(RenameSite(f"step {count}"))
        print(count, digest(session.document.state), flush=True)

    timer = QTimer(interval=3)
    timer.timeout.connect(step)
    timer.start()
    desktop.app.exec()


if __name__ == "__main__":
    main()
