"""What the tests of the panels show: the sample site with Chinese names of holes, and two of its surfaces."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("PySide6", reason="the windows need PySide6 (extra gui)")

import geofit
from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.data.prediction import LeftOut, Outlier, PredictionResult, Suggestion, Uncertainty
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.view3d.item import Item
from geofit.gui.view3d.view import SceneView
from geofit.io.site_file import read_site

SITE = Path(__file__).parent.parent / "sample_data" / "site.toml"
WITH_PERIPHERY, FAULT = "T3-T2", "F1"


@cache
def sample_site() -> Site:
    site = read_site(SITE)
    points = site.horizons[WITH_PERIPHERY]
    chinese = points.with_(hole=[f"孔{hole}" if hole else "" for hole in points.hole.tolist()])
    horizons = {**site.horizons, WITH_PERIPHERY: chinese}
    holes = tuple(replace(hole, name=f"孔{hole.name}") for hole in site.holes)
    return replace(site, horizons=horizons, holes=holes)


@cache
def fitted(name: str = WITH_PERIPHERY) -> HorizonFit:
    site = sample_site()
    return geofit.fit_horizon(site.horizons[name], site.settings[name], boundary=site.boundary, name=name)


def failing(surface: HorizonFit) -> HorizonFit:
    """The same surface with a check that does not pass."""
    assert surface.accuracy is not None
    return surface.with_(accuracy=replace(surface.accuracy, sigma=0.61, passed=False))


def item_of(view: SceneView, key: str) -> Item:
    """Return what a visible layer has put into the scene."""
    return next(item for layer, item in view.contents.stage.items() if layer.key == key)


def cloud(n: int) -> HorizonFit:
    """A surface with n points whose check is made up: a table does not mind."""
    rng = np.random.default_rng(5)
    points = PointSet(
        rng.uniform(0, 1000, (n, 3)),
        kind=rng.choice(["borehole", "section"], n),
        hole=[f"ZK{i % 977}" for i in range(n)],
        row=np.arange(n) + 2,
        file="cloud.csv",
    )
    base = fitted()
    assert base.accuracy is not None
    d = rng.normal(0, 0.08, n)
    worst = tuple(int(i) for i in np.argsort(-np.abs(d))[:20])
    a = replace(base.accuracy, n=n, residuals=d, patch=np.full(n, "core"), worst=worst, conflicts=())
    return base.with_(points=points, core=np.arange(n) % 3 == 0, accuracy=a, model=None)


def prediction(n: int) -> PredictionResult:
    x, y = np.linspace(0, 100, 5), np.linspace(0, 200, 9)
    left = [
        LeftOut(scheme, 12, np.full(n, ""), np.zeros(n), np.ones(n), 1.25, 0.9, -0.1, 4.0, 0.91, 0.74, references)
        for scheme, references in (("hole", {"thin plate": 1.5, "kriging": 1.4}), ("section", {"thin plate": 2.5}))
    ]
    return PredictionResult(
        tuple(left),  # type: ignore[arg-type]
        Uncertainty(x, y, np.full((9, 5), 2.0), 1.62, 1.1, 6.2, np.full((9, 5), 1.62)),
        (Suggestion(10.0, 20.0, 1210.5, 6.2, 1.0, 5.9), Suggestion(30.0, 40.0, 1211.5, 5.8, 0.9, 5.2)),
        (Outlier(7, 1.9, 0.4, 4.75), Outlier(3, -1.2, 0.4, -3.0)),
        (message("test.sections-cross", "Two sections cross; they are left out together"),),
    )
