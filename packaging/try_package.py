"""Start the packaged programs: ``python packaging/try_package.py dist/geofit``.

The command line says its version and fits a horizon with STEP, read-back and report; the window opens that site. Size
and times are printed. Where there is no display, Xvfb makes one.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tools"))

from screenshots import display  # noqa: E402

#: Seconds until the window must have opened the site.
PATIENCE = 120.0


def main() -> int:
    """Try both programs; return 0 if they work."""
    folder = Path(sys.argv[1]).resolve()
    ending = ".exe" if sys.platform.startswith("win") else ""
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    print(f"{folder.name}: {size / 1e6:.0f} MB")
    line, window = folder / f"geofit{ending}", folder / f"geofit-gui{ending}"
    display()
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        site = ROOT / "sample_data" / "site.toml"
        _timed([line, "--version"], place)
        _timed([window, "--version"], place)
        _timed([line, "fit", site, "--horizon", "F1", "--out", place / "out"], place)
        for file in ("F1.step", "F1.png", "report.html"):
            if not (place / "out" / file).is_file():
                sys.exit(f"geofit wrote no {file}.")
        _open(window, site, place)
    print("Both programs work.")
    return 0


def _timed(command: list[object], place: Path) -> None:
    start = time.monotonic()
    done = subprocess.run([str(word) for word in command], cwd=place, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{command[0]} {command[1]}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    print(f"{Path(str(command[0])).name} {command[1]}: {time.monotonic() - start:.1f} s")


def _open(window: Path, site: Path, place: Path) -> None:
    """Open a site in the window: when the session's journal names it, it is open."""
    homes = {name: str(place / name) for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_DATA_HOME", "LOCALAPPDATA")}
    start = time.monotonic()
    with (place / "said").open("w+", encoding="utf-8") as said:
        program = subprocess.Popen(
            [str(window), str(site)], cwd=place, env={**os.environ, **homes}, stdout=said, stderr=said
        )
        try:
            while not any(place.rglob("sessions/*")):
                if program.poll() is not None or time.monotonic() - start > PATIENCE:
                    said.seek(0)
                    sys.exit(f"geofit-gui did not open the site (exit code {program.poll()}).\n{said.read()}")
                time.sleep(0.1)
            print(f"geofit-gui opened the site after {time.monotonic() - start:.1f} s")
            time.sleep(3)  # its 3D view is drawn
            if program.poll() is not None:
                said.seek(0)
                sys.exit(f"geofit-gui ended by itself (exit code {program.returncode}).\n{said.read()}")
        finally:
            program.terminate()
            program.wait(30)
        said.seek(0)
        if "Traceback" in said.read():
            said.seek(0)
            sys.exit(said.read())


if __name__ == "__main__":
    sys.exit(main())
