"""The scene as a picture for print: rendered anew with more pixels, letters and lines as large as on the screen."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path

import numpy as np
from PySide6.QtCore import QBuffer, QByteArray, QIODevice
from PySide6.QtGui import QImage, QImageWriter, QPainter
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter

from geofit.data.errors import SettingsError
from geofit.data.files import replacing
from geofit.data.messages import message
from geofit.gui.view3d.canvas import Canvas
from geofit.gui.view3d.stage import Stage

__all__ = ["picture", "write_screenshot"]

#: Most pixels a side: what every OpenGL can draw into.
MOST = 16_000
#: Pixels a metre of paper at 96 to the inch, times the scale.
SCREEN = 96 / 0.0254


def write_screenshot(
    canvas: Canvas, stage: Stage, path: str | PathLike[str], scale: float, write: Callable[[QPainter], None]
) -> QImage:
    """Write the scene as PNG with ``scale`` times the widget's pixels; ``write`` draws what is drawn over it.

    Raises
    ------
    SettingsError
        If the scale is not above 0, or makes over 16,000 pixels a side.
    """
    width, height = round(canvas.width() * scale), round(canvas.height() * scale)
    if not (scale > 0 and 0 < max(width, height) <= MOST):
        raise SettingsError(
            message(
                "gui.picture-too-large",
                "A scale of {scale:g} makes a picture of {width} × {height} pixels; give one above 0 and below "
                "{most:.1f}.",
                scale=scale,
                width=width,
                height=height,
                most=MOST / max(canvas.width(), canvas.height()),
            )
        )
    image = picture(canvas, stage, scale, write)
    for put in (image.setDotsPerMeterX, image.setDotsPerMeterY):
        put(round(SCREEN * scale))
    buffer = QBuffer()
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    QImageWriter(buffer, QByteArray(b"png")).write(image)
    with replacing(Path(path)) as temporary:
        Path(temporary).write_bytes(bytes(buffer.data().data()))
    return image


def picture(canvas: Canvas, stage: Stage, scale: float, write: Callable[[QPainter], None]) -> QImage:
    """Return the scene with ``scale`` times the widget's pixels; ``write`` draws what is drawn over it."""
    image = _rendered(canvas, stage, round(canvas.width() * scale), round(canvas.height() * scale), scale)
    painter = QPainter(image)
    painter.scale(scale, scale)
    write(painter)
    painter.end()
    return image


def _rendered(canvas: Canvas, stage: Stage, width: int, height: int, scale: float) -> QImage:
    window, before = canvas.ren_win, tuple(canvas.ren_win.GetSize())
    canvas.realize()
    full = canvas.full
    stage.set_detail(True)
    stage.set_pixels(scale)
    window.MakeCurrent()
    window.SetSize(width, height)
    stage.renew(canvas.projector(), width * height)
    canvas.place()
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.ShouldRerenderOff()
    grab.Update()
    shot = grab.GetOutput()
    columns, rows, _ = shot.GetDimensions()
    pixels = vtk_to_numpy(shot.GetPointData().GetScalars()).reshape(rows, columns, -1)[::-1, :, :3]
    data = np.ascontiguousarray(pixels)
    image = QImage(data.data, columns, rows, 3 * columns, QImage.Format.Format_RGB888).copy()
    window.SetSize(*before)
    stage.set_pixels(canvas.devicePixelRatioF())
    stage.set_detail(full)
    return image
