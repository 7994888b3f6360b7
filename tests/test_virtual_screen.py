"""Without a screen or a library of the system the windows' tests are skipped with the remedy; nothing aborts."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
WINDOWS = "tests/gui/test_histogram.py"
linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="displays are named by DISPLAY on Linux only")


def run(tests: str, **changes: str) -> subprocess.CompletedProcess[str]:
    """Run the tests of a file in an environment without a display; an empty value removes the variable."""
    environment = {**os.environ, "DISPLAY": "", "WAYLAND_DISPLAY": "", **changes}
    environment = {name: value for name, value in environment.items() if value}
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", tests],
        cwd=ROOT, env=environment, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip


def skipped(done: subprocess.CompletedProcess[str]) -> str:
    """The one line that states why all tests were skipped."""
    assert done.returncode in (0, 5), done.stdout + done.stderr
    assert "Aborted" not in done.stdout + done.stderr
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("SKIPPED")]
    assert "make system-packages" in line
    return line


@linux
def test_without_xvfb_the_windows_are_skipped(tmp_path):
    assert "no Xvfb" in skipped(run(WINDOWS, PATH=str(tmp_path)))


@linux
def test_with_an_xvfb_that_ends_at_once_the_windows_are_skipped(tmp_path):
    (tmp_path / "Xvfb").write_text("#!/bin/sh\nexit 1\n")
    (tmp_path / "Xvfb").chmod(0o755)
    assert "Xvfb does not start" in skipped(run(WINDOWS, PATH=f"{tmp_path}:{os.environ['PATH']}"))


@linux
@pytest.mark.skipif(shutil.which("Xvfb") is None, reason="Xvfb is not installed")
def test_where_qt_cannot_start_the_windows_are_skipped():
    # What Qt does where a library of its xcb platform is missing: it aborts the process.
    assert "nowhere" in skipped(run(WINDOWS, QT_QPA_PLATFORM="nowhere"))


@linux
@pytest.mark.skipif(shutil.which("Xvfb") is None, reason="Xvfb is not installed")
def test_a_library_of_the_system_that_is_missing_is_named(tmp_path):
    (tmp_path / "PySide6").mkdir()
    (tmp_path / "PySide6" / "__init__.py").write_text(
        "raise ImportError('libEGL.so.1: cannot open shared object file: No such file or directory')\n"
    )
    # pytest-qt would import the broken package itself.
    done = run(WINDOWS, PYTHONPATH=str(tmp_path), PYTEST_ADDOPTS="-p no:pytest-qt")
    assert "libEGL.so.1: cannot open shared object file" in skipped(done)


#: Speaks to its screen at the very end, as VTK does.
LAST_WORD = """
import atexit, ctypes, os
x11 = ctypes.CDLL("libX11.so.6")
x11.XOpenDisplay.restype = ctypes.c_void_p
atexit.register(lambda: x11.XSync(ctypes.c_void_p(connection), 0))
import virtual_screen
assert virtual_screen.start("640x480") is None
print(os.environ["DISPLAY"], flush=True)
connection = x11.XOpenDisplay(None)
assert connection
"""


@linux
@pytest.mark.skipif(shutil.which("Xvfb") is None, reason="Xvfb is not installed")
def test_the_screen_ends_after_the_process_and_not_before():
    done = subprocess.run(
        [sys.executable, "-c", LAST_WORD], env={**os.environ, "PYTHONPATH": str(ROOT / "tools")},
        capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    lock = Path(f"/tmp/.X{done.stdout.strip().removeprefix(':')}-lock")
    deadline = time.monotonic() + 20
    while lock.exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not lock.exists()


@pytest.mark.skipif(not sys.platform.startswith("linux") or shutil.which("bash") is None, reason="a script for Linux")
def test_the_packages_that_are_missing_are_named_on_one_line(tmp_path):
    for name in ("ldconfig", "fc-list"):
        (tmp_path / name).write_text("#!/bin/sh\n")
        (tmp_path / name).chmod(0o755)
    done = subprocess.run(
        ["bash", str(ROOT / "tools" / "system_packages.sh"), "missing"],
        env={**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    (line,) = done.stdout.splitlines()
    assert {"libgl1", "libxcb-cursor0", "fonts-noto-cjk"} <= set(line.replace(".", "").split())
    assert "make system-packages" in line


def test_one_list_of_packages_serves_all():
    assert "tools/system_packages.sh" in (ROOT / ".ci" / "run").read_text()
    assert "tools/system_packages.sh" in (ROOT / "Makefile").read_text()
    assert "make system-packages" in (ROOT / "README.md").read_text(encoding="utf-8")
    for name in (".ci/run", "README.md", "Makefile"):
        assert "libxcb" not in (ROOT / name).read_text(encoding="utf-8")
