"""How the residuals are spread: counted in bars, and against a normal law."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geofit.data.languages import EN, Language
from geofit.report.result import HorizonResult
from geofit.report.style import CORE, FAIL, LINE, MUTED, PAPER, TEXT, quiet_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["histogram", "normal_plot"]

#: Residuals below this are the rounding of the computer, metres.
NOISE = 1e-9


def histogram(axes: Axes, result: HorizonResult, t: Language = EN) -> None:
    """Draw how many residuals lie where, with the tolerances as bounds; exact core points are left out.

    The axis ends at the largest residual; a tolerance beyond it is named in the legend only.
    """
    from matplotlib.collections import PolyCollection

    a, settings = result.accuracy, result.surface.settings
    d = a.residuals[~result.core]
    axes.set_title(t("Residuals of the approximated points"))
    widest = float(np.abs(d).max(initial=0.0)) * 1.04
    if widest < NOISE:
        _nothing(axes, t)
        return
    counts, edges = np.histogram(d, np.linspace(-widest, widest, 42))
    # One collection: as many patches cost as many times more, in the window at every new picture.
    bars = [[(a, 0), (a, n), (b, n), (b, 0)] for a, b, n in zip(edges, edges[1:], counts, strict=False) if n]
    axes.add_collection(PolyCollection(bars, facecolor="#8fa9bd", edgecolor=PAPER, lw=0.5, zorder=2))
    axes.set_ylim(0, 1.05 * counts.max())
    for value, colour, dashes, label in (
        (
            settings.interior_tolerance,
            MUTED,
            "dashed",
            t("interior tolerance {value:g} m", value=float(settings.interior_tolerance)),
        ),
        (a.epsilon, FAIL, "solid", t("control error ε {value:g} m", value=float(a.epsilon))),
    ):
        if value <= widest:
            axes.axvline(-value, color=colour, lw=1.1, ls=dashes, zorder=3)
            axes.axvline(value, color=colour, lw=1.1, ls=dashes, zorder=3, label=label)
        else:
            axes.plot([], [], color=colour, lw=1.1, ls=dashes, label=t("{bound}: off the axis", bound=label))
    axes.set_xlim(-widest, widest)
    axes.locator_params(axis="x", nbins=6)
    axes.locator_params(axis="y", nbins=5, integer=True)
    axes.set_xlabel(t("d, m (below the surface < 0 < above)"))
    axes.set_ylabel(t("points"))
    axes.grid(axis="y", color=LINE, lw=0.6, zorder=0)
    axes.set_axisbelow(True)
    quiet_axes(axes)
    axes.legend(loc="upper left", bbox_to_anchor=(0, -0.3), borderaxespad=0, labelcolor=TEXT)


def normal_plot(axes: Axes, result: HorizonResult, t: Language = EN) -> None:
    """Draw the sorted residuals of the approximated points against the quantiles of a normal law."""
    from scipy.special import ndtri

    d = np.sort(result.accuracy.residuals[~result.core])
    axes.set_title(t("Normal probability plot"))
    if np.abs(d).max(initial=0.0) < NOISE:
        _nothing(axes, t)
        return
    at = ndtri((np.arange(len(d)) + 0.5) / len(d))
    axes.plot(at, d.mean() + d.std() * at, color=MUTED, lw=1.0, ls="dashed", label=t("normal distribution"), zorder=2)
    axes.plot(at, d, ".", ms=3.2, color=CORE, label=t("residuals"), zorder=3, rasterized=True)
    axes.set_xlabel(t("quantile of the normal distribution"))
    axes.set_ylabel(t("d, m"))
    axes.grid(color=LINE, lw=0.6, zorder=0)
    axes.set_axisbelow(True)
    quiet_axes(axes)
    axes.legend(loc="upper left", bbox_to_anchor=(0, -0.3), borderaxespad=0, labelcolor=TEXT, ncols=2)


def _nothing(axes: Axes, t: Language) -> None:
    axes.text(
        0.5, 0.5, t("Every point is interpolated exactly;\nno residual to count."),
        ha="center", va="center", color=MUTED, transform=axes.transAxes,
    )  # fmt: skip
    axes.set_axis_off()
