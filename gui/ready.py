"""Whether a window can open on this machine; asked before Qt is imported, because Qt aborts where it cannot start."""

from __future__ import annotations

import ctypes.util
import importlib.util
import os
import sys

from geofit.data.distribution import install_line
from geofit.data.errors import MissingDependencyError
from geofit.data.messages import message, plural_message

__all__ = ["require_display", "require_packages"]

#: What Qt's xcb platform loads by itself and a fresh Linux machine may lack, with its Debian package.
XCB = {
    "X11": "libx11-6",
    "xcb-cursor": "libxcb-cursor0",
    "xcb-icccm": "libxcb-icccm4",
    "xcb-keysyms": "libxcb-keysyms1",
    "xkbcommon-x11": "libxkbcommon-x11-0",
    "EGL": "libegl1",
    "GL": "libgl1",
}


def require_packages() -> None:
    """Return if the packages of the windows are installed; MissingDependencyError with the install line if not."""
    missing = [name for name in ("PySide6", "pyvistaqt") if not _installed(name)]
    if missing:
        raise MissingDependencyError(
            plural_message(
                "gui.packages-missing",
                "The windows need {names}, which is not installed. Install with: {install}",
                "The windows need {names}, which are not installed. Install with: {install}",
                count=len(missing),
                names=" and ".join(missing),
                install=install_line("gui"),
            )
        )


def _installed(name: str) -> bool:
    try:
        return importlib.util.find_spec(name) is not None
    except ModuleNotFoundError:
        return False


def require_display() -> None:
    """Return if there is a screen to open a window on, and what Qt needs to reach it (Linux).

    Raises
    ------
    MissingDependencyError
        If neither DISPLAY nor WAYLAND_DISPLAY is set, or libraries are missing; the text states what to do.
    """
    if not sys.platform.startswith("linux") or os.environ.get("QT_QPA_PLATFORM", "xcb") not in ("xcb", "wayland"):
        return
    if not os.environ.get("DISPLAY") and not os.environ.get("WAYLAND_DISPLAY"):
        raise MissingDependencyError(
            message(
                "gui.no-display",
                "There is no display: neither DISPLAY nor WAYLAND_DISPLAY is set. Start geofit-gui on a desktop, over "
                "'ssh -X', or under a virtual screen (xvfb-run geofit-gui). The command line needs "
                "no display: geofit -h.",
            )
        )
    if not os.environ.get("WAYLAND_DISPLAY") and not _answers():
        raise MissingDependencyError(
            message(
                "gui.display-silent",
                "The display '{display}' does not answer. Check DISPLAY, log in on that screen, or use a virtual one "
                "(xvfb-run geofit-gui).",
                display=os.environ["DISPLAY"],
            )
        )
    missing = [package for name, package in XCB.items() if ctypes.util.find_library(name) is None]
    if missing and not os.environ.get("WAYLAND_DISPLAY"):
        raise MissingDependencyError(
            message(
                "gui.qt-libraries-missing",
                "Qt needs libraries that this machine lacks. Install them (Debian and Ubuntu: apt-get install "
                "{packages}) and start again.",
                packages=" ".join(missing),
            )
        )


def _answers() -> bool:
    """Whether the X server of DISPLAY lets us in; Qt would abort the process if it does not."""
    name = ctypes.util.find_library("X11")
    if name is None:
        return True  # said below, with what else is missing
    x11 = ctypes.CDLL(name)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = x11.XOpenDisplay(None)
    if display is None:
        return False
    x11.XCloseDisplay(ctypes.c_void_p(display))
    return True
