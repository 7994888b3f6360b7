"""Starting: what the machine lacks is said on stderr with exit code 2, before Qt could abort."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest


def start(*args: str, env: dict[str, str] | None = None, code: str = "") -> subprocess.CompletedProcess[str]:
    known = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")}
    command = code + "import sys; from geofit.gui.app import main; sys.exit(main(sys.argv[1:]))"
    return subprocess.run(
        [sys.executable, "-c", command, *args],
        capture_output=True, text=True, check=False, timeout=120, env=known | (env or {}),
    )  # fmt: skip


linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="displays are named by DISPLAY on Linux only")


@linux
def test_no_display():
    done = start()
    assert done.returncode == 2
    assert "neither DISPLAY nor WAYLAND_DISPLAY is set" in done.stderr
    assert "xvfb-run" in done.stderr
    assert "Traceback" not in done.stderr


@linux
def test_a_display_that_does_not_answer():
    done = start(env={"DISPLAY": ":31999"})
    assert done.returncode == 2
    assert "':31999' does not answer" in done.stderr


@linux
def test_no_opengl():
    done = start(env={"QT_QPA_PLATFORM": "offscreen"})
    assert done.returncode == 2
    assert "3D view needs a display" in done.stderr


@linux
def test_missing_libraries_are_named_with_their_packages():
    code = (
        "import ctypes.util; real = ctypes.util.find_library\n"
        "ctypes.util.find_library = lambda n: None if n == 'xcb-cursor' else real(n)\n"
    )
    done = start(env={"DISPLAY": os.environ["DISPLAY"]}, code=code)
    assert done.returncode == 2
    assert "apt-get install libxcb-cursor0" in done.stderr


def test_no_such_file():
    done = start("no-such.geofit")
    assert done.returncode == 2
    assert "no file no-such.geofit" in done.stderr


def test_version():
    import geofit

    assert start("--version").stdout.strip() == f"geofit {geofit.__version__}"


@linux
def test_the_command_line_opens_it_too():
    env = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run(
        [sys.executable, "-m", "geofit", "gui"], capture_output=True, text=True, check=False, env=env, timeout=120
    )
    assert done.returncode == 2
    assert "There is no display" in done.stderr
