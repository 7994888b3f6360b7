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


def start(size: str) -> subprocess.Popen[bytes] | str:
    """Start Xvfb with a screen of ``size`` ("1600x1000") and set DISPLAY; return the server, or why there is none."""
    program = shutil.which("Xvfb")
    if program is None:
        return NO_PROGRAM
    reading, writing = os.pipe()
    # Xvfb chooses a free number itself and writes it, in pieces, when it is ready.
    server = subprocess.Popen(
        [program, "-displayfd", str(writing), "-screen", "0", f"{size}x24", "-nolisten", "tcp"],
        pass_fds=[writing],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(writing)
    said = b""
    # To the end of the line: a server that cannot write it all ends again.
    while not said.endswith(b"\n") and select.select([reading], [], [], PATIENCE)[0]:
        piece = os.read(reading, 16)
        if not piece:
            break
        said += piece
    os.close(reading)
    if not said.endswith(b"\n"):
        server.kill()
        server.wait()
        return f"no display, and Xvfb does not start; {REMEDY}"
    os.environ["DISPLAY"] = f":{said.decode().strip()}"
    return server
