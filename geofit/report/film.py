"""A film of bodies: pictures of one camera as GIF, or as MP4 where its encoder is installed."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import MissingDependencyError, SettingsError
from geofit.data.files import replacing
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.mesh import TriangleMesh
from geofit.report.scene import require_rendering

if TYPE_CHECKING:
    from geofit.morphing.body import MorphBody

__all__ = ["body_pictures", "require_encoder", "save_film", "write_film"]

Pixels = NDArray[np.uint8]

#: Frames a second, and how many frames the first and the last one stay.
RATE, HOLD = 12, 8
#: Colours of interpolated frames, of surveys, and of the ends in the background.
BETWEEN, SURVEY, GHOST = "#8fa7b3", "#b4895a", "#6b6b6b"
#: The viewpoint: from the south-west, above.
VIEWPOINT = (-0.55, -0.8, 0.45)


@arguments_checked
def write_film(bodies: Sequence[MorphBody], path: str | PathLike[str]) -> Path:
    """Write the frames of a metamorphosis as a film: surveys and what is interpolated in different colours.

    Parameters
    ----------
    bodies : sequence of MorphBody
        Frames in order, such as ``m.frames(25)``; each picture says its date or tau and its volume in m3.
    path : path
        A file that ends in ``.gif``, or in ``.mp4`` where the program ffmpeg is installed.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    SettingsError
        If there is no frame, the ending is another, or ffmpeg fails.
    MissingDependencyError
        If there is no OpenGL library, or no encoder of MP4.

    Notes
    -----
    One camera from the south-west; the first and the last body are drawn sheer behind each frame: ``docs/morph.md``.
    """
    if len(bodies) == 0:
        raise SettingsError(message("report.film-without-frames", "A film of no frames; give at least one body."))
    labels = [
        f"{body.date.isoformat() if body.date else f'tau {body.tau:.2f}'}   {body.volume:,.0f} m3   "
        + ("interpolated" if body.interpolated else "survey")
        for body in bodies
    ]
    surveys = [not body.interpolated for body in bodies]
    return save_film(body_pictures([body.mesh for body in bodies], labels, surveys=surveys), path)


def body_pictures(
    meshes: Sequence[TriangleMesh],
    labels: Sequence[str],
    *,
    surveys: Sequence[bool],
    size: tuple[int, int] = (760, 560),
) -> list[Pixels]:
    """Return a picture of each mesh, all by one camera, with the first and the last one as onion skin.

    Parameters
    ----------
    meshes : sequence of TriangleMesh
        Frames in map coordinates, metres.
    labels : sequence of str
        Text in the corner of each picture.
    surveys : sequence of bool
        Whether a frame is a survey itself: it gets another colour than what lies between.
    size : tuple of 2 int
        Width and height in pixels.

    Raises
    ------
    MissingDependencyError
        If there is no OpenGL library.
    """
    require_rendering()
    import pyvista as pv

    full = [mesh for mesh in meshes if len(mesh.vertices)]
    low = np.min([mesh.vertices.min(axis=0) for mesh in full], axis=0)
    high = np.max([mesh.vertices.max(axis=0) for mesh in full], axis=0)
    middle, reach = (low + high) / 2, float(np.linalg.norm(high - low))

    def shape(mesh: TriangleMesh) -> Any:
        faces = np.insert(mesh.triangles, 0, 3, axis=1)
        return pv.PolyData(mesh.vertices - middle, faces.ravel())

    plotter = pv.Plotter(off_screen=True, window_size=size)
    try:
        plotter.set_background("white")
        for mesh in (meshes[0], meshes[-1]):
            if len(mesh.triangles):
                plotter.add_mesh(shape(mesh), color=GHOST, opacity=0.1, show_edges=False)
        eye = np.array(VIEWPOINT) / np.linalg.norm(VIEWPOINT)
        plotter.camera_position = [tuple(1.4 * reach * eye), (0, 0, 0), (0, 0, 1)]
        plotter.camera.view_angle = 32
        plotter.enable_anti_aliasing("ssaa")
        images = []
        for mesh, label, survey in zip(meshes, labels, surveys, strict=True):
            if len(mesh.triangles):
                plotter.add_mesh(
                    shape(mesh), color=SURVEY if survey else BETWEEN, smooth_shading=True, specular=0.2, name="body"
                )
            else:
                plotter.remove_actor("body")
            plotter.add_text(label, position="lower_left", font_size=11, color="#333333", name="label")
            images.append(np.asarray(plotter.screenshot(return_img=True))[..., :3].copy())
    finally:
        plotter.close()
    return images


def save_film(images: Sequence[Pixels], path: str | PathLike[str]) -> Path:
    """Write pictures as a film, there and back: GIF, or MP4 with the program ffmpeg.

    Parameters
    ----------
    images : sequence of (height, width, 3) arrays of uint8
        The pictures.
    path : path
        A file that ends in ``.gif`` or ``.mp4``.

    Raises
    ------
    SettingsError
        If the ending is another, or ffmpeg fails.
    MissingDependencyError
        If ffmpeg is wanted and not installed.
    """
    target = Path(path)
    held = [images[0]] * HOLD + list(images[1:-1]) + [images[-1]] * HOLD
    match target.suffix.casefold():
        case ".gif":
            from PIL import Image

            # One palette for the whole film, from all its pictures: colours that change would flicker. It covers
            # rare colours, too: those of a legend are.
            some = np.concatenate([image[::4, ::4] for image in images])
            palette = Image.fromarray(some).quantize(256, method=Image.Quantize.MAXCOVERAGE)
            pictures = [Image.fromarray(image).quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
            times = [1000 // RATE] * len(images)
            times[0] = times[-1] = HOLD * 1000 // RATE
            with replacing(target) as part:
                pictures[0].save(part, save_all=True, append_images=pictures[1:], duration=times, loop=0, optimize=True)
        case ".mp4":
            program = require_encoder()
            height, width = (side - side % 2 for side in images[0].shape[:2])
            command = [program, "-v", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}"]
            command += ["-r", str(RATE), "-i", "-", "-pix_fmt", "yuv420p", "-fflags", "+bitexact", "-f", "mp4", "-y"]
            frames = b"".join(np.ascontiguousarray(image[:height, :width]).tobytes() for image in held)
            with replacing(target) as part:
                done = subprocess.run([*command, str(part)], input=frames, capture_output=True, check=False)
                if done.returncode:
                    reason = done.stderr.decode(errors="replace").strip() or f"exit code {done.returncode}"
                    raise SettingsError(
                        message("report.film-failed", "ffmpeg cannot write the film: {error}", error=reason)
                    )
        case ending:
            raise SettingsError(
                message("report.film-ending", "A film ends in .gif or .mp4, not in '{ending}'.", ending=ending)
            )
    return target


def require_encoder() -> str:
    """Return the program that encodes MP4.

    Raises
    ------
    MissingDependencyError
        If ffmpeg is not installed.
    """
    program = shutil.which("ffmpeg")
    if program is None:
        raise MissingDependencyError(
            message(
                "report.film-encoder",
                "MP4 needs the program ffmpeg, which is not installed. Install it (Debian and Ubuntu: "
                "apt-get install ffmpeg), or write a GIF, which needs nothing.",
            )
        )
    return program
