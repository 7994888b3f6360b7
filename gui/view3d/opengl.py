"""Whether a 3D view can be drawn here: asked before VTK is, because VTK aborts the process where it cannot."""

from __future__ import annotations

import ctypes
import sys

from PySide6.QtGui import QGuiApplication, QOffscreenSurface, QOpenGLContext, QSurfaceFormat

from geofit.data.errors import MissingDependencyError
from geofit.data.messages import message

__all__ = ["NoOpenGLError", "require_opengl"]

#: Platforms of Qt that have no OpenGL.
FLAT = ("offscreen", "minimal", "vnc", "linuxfb")
#: What VTK's shaders need.
VERSION = (3, 2)


class NoOpenGLError(MissingDependencyError):
    """There is no OpenGL for a 3D view; the text states what is missing."""


def require_opengl() -> None:
    """Return if a 3D view can be drawn.

    Raises
    ------
    NoOpenGLError
        If there is no display, no OpenGL library, or OpenGL is older than 3.2.
    """
    platform = QGuiApplication.platformName()
    if platform in FLAT:
        raise NoOpenGLError(
            message(
                "gui.no-display-for-3d",
                "The 3D view needs a display; Qt runs on its '{platform}' platform, which has no OpenGL. "
                "Start the application on a desktop (or under Xvfb), without QT_QPA_PLATFORM set.",
                platform=platform,
            )
        )
    if sys.platform.startswith("linux"):
        name = "libEGL.so.1" if platform.startswith("wayland") else "libGL.so.1"
        try:
            ctypes.CDLL(name)
        except OSError:
            raise NoOpenGLError(
                message(
                    "gui.opengl-library-missing",
                    "The 3D view needs OpenGL; the library {name} is missing on this machine. "
                    "Install it (Debian and Ubuntu: apt-get install libgl1 libegl1) and start again.",
                    name=name,
                )
            ) from None
    found = _version()
    if found is None or found < VERSION:
        have = (
            message("gui.driver-without-opengl", "gives no OpenGL at all")
            if found is None
            else message("gui.driver-opengl", "gives OpenGL {major}.{minor}", major=found[0], minor=found[1])
        )
        raise NoOpenGLError(
            message(
                "gui.opengl-too-old",
                "The 3D view needs OpenGL {major}.{minor}; the graphics driver {have}. Update the driver, or use "
                "Mesa's software renderer (LIBGL_ALWAYS_SOFTWARE=1 on Linux).",
                major=VERSION[0],
                minor=VERSION[1],
                have=have,
            )
        )


def _version() -> tuple[int, int] | None:
    """Return the version of OpenGL that Qt can make a context for, None if it can make none."""
    wanted = QSurfaceFormat()
    wanted.setRenderableType(QSurfaceFormat.RenderableType.OpenGL)
    wanted.setProfile(QSurfaceFormat.OpenGLContextProfile.CoreProfile)
    wanted.setVersion(*VERSION)
    context, surface = QOpenGLContext(), QOffscreenSurface()
    context.setFormat(wanted)
    surface.setFormat(wanted)
    surface.create()
    if not (context.create() and surface.isValid() and context.makeCurrent(surface)):
        return None
    version = context.format().majorVersion(), context.format().minorVersion()
    context.doneCurrent()
    surface.destroy()
    return version
