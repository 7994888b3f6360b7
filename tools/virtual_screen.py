"""A virtual screen for the tests of the windows and for their pictures, where there is no display."""

from __future__ import annotations

import os
import select
import shutil
import subprocess
import sys

__all__ = ["REMEDY", "start", "why_no_window"]

REMEDY = "install what is missing with: make system-packages"
NO_PROGRAM = f"no display, and no Xvfb to make one; {REMEDY}"
#: Seconds until the server must have said its number.
PATIENCE = 20.0
#: The shells that watch over the servers started here: kept, so that none is taken for forgotten.
_SCREENS: list[subprocess.Popen[bytes]] = []


#: Opens what the windows need. Qt and VTK abort the process where they cannot start, so a child tries it.
_PROBE = """
from PySide6.QtWidgets import QApplication
application = QApplication([])
from geofit.gui.view3d.opengl import require_opengl
require_opengl()
"""


def why_no_window() -> str | None:
    """Return why no window can open on this display, in one line; None where it can."""
    tried = subprocess.run(
        [sys.executable, "-c", _PROBE], capture_output=True, text=True, errors="replace", check=False
    )
    if tried.returncode == 0:
        return None
    told = [line.strip() for line in tried.stderr.splitlines() if line.strip()] or [f"exit code {tried.returncode}"]
    # Python names its error last; Qt names it first, and lists its plugins below.
    why = told[-1] if told[-1].split(":")[0].endswith("Error") else told[0]
    return f"no window can open here ({why}); {REMEDY}"


def start(size: str) -> str | None:
    """Start Xvfb with a screen of ``size`` ("1600x1000") and set DISPLAY; return why there is none, None if there is.

    The screen ends after this process, however that ends: Qt and Xlib abort where their screen goes before they do,
    and VTK keeps connections until the very last.
    """
    program = shutil.which("Xvfb")
    if program is None:
        return NO_PROGRAM
    guard, held = os.pipe()
    # Only the end of the process closes ``held``; then the shell reads the end of its input, and ends the server.
    # Xvfb chooses a free number itself and writes it when it is ready.
    server = [program, "-displayfd", "1", "-screen", "0", f"{size}x24", "-nolisten", "tcp"]
    shell = subprocess.Popen(
        ["/bin/sh", "-c", '"$@" & exec >/dev/null; read _; kill $!', "sh", *server],
        stdin=guard,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    os.close(guard)
    assert shell.stdout is not None
    said = b""
    # In pieces, to the end of the line: a server that cannot write it all ends again.
    while not said.endswith(b"\n") and select.select([shell.stdout], [], [], PATIENCE)[0]:
        piece = os.read(shell.stdout.fileno(), 16)
        if not piece:
            break
        said += piece
    shell.stdout.close()
    if not said.endswith(b"\n"):
        os.close(held)
        shell.wait()
        return f"no display, and Xvfb does not start; {REMEDY}"
    _SCREENS.append(shell)
    os.environ["DISPLAY"] = f":{said.decode().strip()}"
    return None
