"""A virtual screen for the tests of the windows and for their pictures, where there is no display."""

from __future__ import annotations

import os
import select
import shutil
import subprocess

__all__ = ["NO_PROGRAM", "start"]

NO_PROGRAM = "no display, and no Xvfb to make one (Debian and Ubuntu: apt-get install xvfb)"
#: Seconds until the server must have said its number.
PATIENCE = 20.0


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
        return "no display, and Xvfb does not start"
    os.environ["DISPLAY"] = f":{said.decode().strip()}"
    return server
