"""Pictures of the desktop application in every main state: two languages, two themes, two scales.

``python tools/screenshots.py [--out docs/screenshots] [--only en-light-1x]``. The real windows are driven on the sample
site; where there is no display, Xvfb makes one. The sets that the documents show are small enough for the repository
(``KEPT``), the others are git-ignored.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import virtual_screen

ROOT = Path(__file__).resolve().parents[1]
SCALES = ("1", "1.5")
LOOKS = (("en", "light"), ("zh", "dark"), ("en", "dark"), ("zh", "light"))
#: Sets that belong to the repository.
KEPT = ("en-light-1x", "zh-dark-1x")
#: A fixed day in the report's dialog.
DAY = "1767225600"


def main() -> int:
    """Take the pictures, one process for each scale: Qt reads it once, at the start."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "screenshots", help="folder for the sets")
    parser.add_argument("--only", nargs="+", metavar="SET", help="sets to take, as en-light-1x or zh-dark-1.5x")
    parser.add_argument("--states", nargs="+", metavar="STATE", help="states to keep, by the start of their names")
    parser.add_argument("--child", nargs="+", metavar="SET", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.child:
        from screen_states import take

        take(asked.out, asked.child, tuple(asked.states or ()))
        return 0
    status = 0
    display()
    for scale in SCALES:
        sets = [f"{language}-{theme}-{scale}x" for language, theme in LOOKS]
        sets = [name for name in sets if not asked.only or name in asked.only]
        if sets:
            status |= _child(asked.out.resolve(), scale, sets, asked.states or [])
    return status


def _child(out: Path, scale: str, sets: list[str], states: list[str]) -> int:
    with tempfile.TemporaryDirectory() as home:
        folders = dict.fromkeys(("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_DATA_HOME"), home)
        environment = {**os.environ, **folders, "QT_SCALE_FACTOR": scale, "SOURCE_DATE_EPOCH": DAY}
        command = [sys.executable, __file__, "--out", str(out), "--child", *sets]
        return subprocess.run([*command, "--states", *states] if states else command, env=environment).returncode


def display() -> None:
    """Have a display: the one that there is, or an Xvfb of our own until the end of the process."""
    if not sys.platform.startswith("linux") or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
        return
    if why := virtual_screen.start("2560x1600"):
        sys.exit(f"No pictures: {why}.")


if __name__ == "__main__":
    sys.exit(main())
