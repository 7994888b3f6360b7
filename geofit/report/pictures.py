"""The pictures of a run as files and as data for the report."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from geofit.errors import MissingDependencyError
from geofit.files import replacing
from geofit.report import plots, scene
from geofit.report.result import HorizonResult
from geofit.report.style import FAIL, INK, MUTED, PASS, drawing

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from geofit.report.scene import Scene

__all__ = ["Pictures", "draw", "write_picture", "write_site_picture"]

#: Without this, the file would carry the version of matplotlib.
_METADATA = {"Software": None}
#: Width of the report's pictures, inches: what an A4 page has between its margins, with small type.
WIDTH = 7.8


@dataclass(frozen=True)
class Pictures:
    """The pictures of one horizon as data addresses, and the scene; ``missing`` says why there is none."""

    plan: str
    deviation: str
    histogram: str
    space: str
    scene: Scene | None
    missing: str


def draw(result: HorizonResult) -> Pictures:
    """Draw all pictures of a horizon."""
    try:
        view: Scene | None = scene.horizon_scene(result)
        missing = ""
    except MissingDependencyError as error:
        view, missing = None, str(error)
    return Pictures(
        plan=_flat(plots.site_plan, result, _height(plots.map_shape(result, plan=True))),
        deviation=_flat(plots.deviation_map, result, _height(plots.map_shape(result, plan=False))),
        histogram=_flat(plots.histogram, result, 2.6),
        space="" if view is None else _space(view),
        scene=view,
        missing=missing,
    )


def write_picture(result: HorizonResult, pictures: Pictures, path: Path) -> None:
    """Write the one picture that shows a horizon: in space, and its deviations."""
    from matplotlib.figure import Figure

    a, view = result.accuracy, pictures.scene
    shape = plots.map_shape(result, plan=False)
    tall = 0.0 if view is None else view.image.shape[0] / view.image.shape[1]
    height = float(np.clip(max(4.6 * shape, 6.4 * tall * 1.1) + 1.9, 4.2, 8.5))
    with drawing():
        figure = Figure(figsize=(14.0, height), dpi=140)
        body = (height - 1.15) / height
        left = figure.add_axes((0.025, 0.12, 0.46, body - 0.12), anchor="N")
        if view is None:
            left.text(0.5, 0.5, "no OpenGL, no 3D picture", ha="center", color=MUTED, transform=left.transAxes)
            left.set_axis_off()
        else:
            plots.space(left, view)
        below = 0.6 / height
        right = figure.add_axes((0.555, below, 0.32, body - below - 0.3 / height))
        plots.deviation_map(right, result)
        top = 1 - 0.5 / height
        figure.text(0.025, top, result.name, size=17, weight="bold", color=INK)
        line = f"{a.n} points, {int(result.core.sum())} in the core · σ = {a.sigma:.3f} m"
        line += f" · largest |d| = {a.max_abs:.2f} m"
        figure.text(0.025, 1 - 0.83 / height, line + (f" · {_scale(view)}" if view else ""), color=MUTED, size=10)
        figure.text(0.555, top, a.verdict, size=17, weight="bold", color=PASS if a.passed else FAIL)
        relation = "is below" if a.passed else "is not below"
        failed = [check.name for check in a.checks if check.passed is False]
        rest = f" · does not hold: {', '.join(failed)}" if failed else ""
        figure.text(0.555, 1 - 0.83 / height, f"σ {relation} ε = {a.epsilon:g} m{rest}", color=MUTED, size=10)
        _save(figure, path)


def write_site_picture(results: Sequence[HorizonResult], path: Path) -> str:
    """Write the picture of all horizons of a site; return why there is none, or an empty text."""
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch as Swatch

    try:
        view = scene.site_scene([r.surface for r in results], results[0].site.holes)
    except MissingDependencyError as error:
        return str(error)
    with drawing():
        width = 11.5
        height = (width - 0.6) * view.image.shape[0] / view.image.shape[1] + 1.1
        figure = Figure(figsize=(width, height), dpi=140)
        axes = figure.add_axes((0.3 / width, 0.2 / height, 1 - 0.6 / width, 1 - 1.1 / height))
        axes.imshow(view.image, interpolation="antialiased")
        axes.set_axis_off()
        figure.text(0.3 / width, 1 - 0.45 / height, results[0].site.name or "Site", size=17, weight="bold")
        figure.text(0.3 / width, 1 - 0.75 / height, view.caption, size=10, color=MUTED)
        swatches = [
            Swatch(facecolor=scene.SEVERAL[i % len(scene.SEVERAL)], label=r.name) for i, r in enumerate(results)
        ]
        figure.legend(
            handles=swatches, loc="upper right", fontsize=10, ncols=min(len(swatches), 6), handlelength=1.2,
            bbox_to_anchor=(1 - 0.25 / width, 1 - 0.2 / height),
        )  # fmt: skip
        _save(figure, path)
    return ""


def _scale(view: Scene) -> str:
    return view.caption.rstrip(".").replace("Seen", "seen")


def _height(shape: float) -> float:
    """Height of a flat picture in inches: the map is about 5.2 wide, axis labels take 0.9."""
    return float(np.clip(5.2 * shape + 0.9, 2.4, 7.0))


def _flat(plot: Callable[[Axes, HorizonResult], None], result: HorizonResult, height: float) -> str:
    from matplotlib.figure import Figure

    with drawing():
        figure = Figure(figsize=(WIDTH, height), dpi=190)
        plot(figure.add_axes((0.115, 0.52 / height, 0.635, 1 - 0.85 / height)), result)
        return _address(figure)


def _space(view: Scene) -> str:
    from matplotlib.figure import Figure

    with drawing():
        wide, tall = view.image.shape[1], view.image.shape[0]
        picture = 0.96 * WIDTH * tall / wide
        height = picture * (1 + plots.BELOW) + 0.35
        figure = Figure(figsize=(WIDTH, height), dpi=190)
        plots.space(figure.add_axes((0.02, 1 - picture / height, 0.96, picture / height)), view)
        return _address(figure)


def _address(figure: Figure) -> str:
    stream = io.BytesIO()
    figure.savefig(stream, format="png", metadata=_METADATA)
    return "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode("ascii")


def _save(figure: Figure, path: Path) -> None:
    with replacing(path) as part:
        figure.savefig(part, format="png", metadata=_METADATA)
