"""A horizon that is made by hand, so that every figure in its report is known; and an examination of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geofit import FitSettings, PointSet, Site
from geofit.checks.storage import equal_accuracy
from geofit.data.accuracy import Accuracy, Check, Conflict, Exceedance, Group, Partition, ReadBack, Seam
from geofit.data.messages import message
from geofit.data.prediction import LeftOut, Outlier, PredictionResult, Suggestion, Uncertainty
from geofit.data.site import Hole, ImportIssue, Section, TableCount
from geofit.fitting.horizon_fit import HorizonFit
from geofit.report.result import HorizonResult
from geofit.splines import bspline
from geofit.splines.patch import Patch
from geofit.surfaces.patch_surface import PatchSurface

ORIGIN = np.array([500_000.0, 3_100_000.0, 1500.0])


def height(x, y):
    return 0.04 * x - 0.02 * y + 12 * np.sin(x / 260) * np.cos(y / 310)


def patch(name: str, x0: float, x1: float, y0: float, y1: float, shape=height) -> Patch:
    u, v = bspline.clamped_knots(np.linspace(x0, x1, 9), 3), bspline.clamped_knots(np.linspace(y0, y1, 9), 3)
    x, y = np.meshgrid(bspline.greville(u, 3), bspline.greville(v, 3), indexing="ij")
    return Patch(name, (3, 3), u, v, np.stack([x, y, shape(x, y)], axis=2))


def group(d) -> Group:
    sigma = float(np.sqrt((d**2).sum() / (len(d) - 1))) if len(d) > 1 else 0.0
    return Group(len(d), sigma, float(np.abs(d).max()), float(d.mean()))


def horizon(name: str = "T3/T2", epsilon: float = 0.5, chinese: bool = False) -> HorizonResult:
    """Three patches, 120 core points without residual, 80 peripheral ones with known residuals."""
    patches = (
        patch("core", 0, 800, -600, 600),
        patch("west", -700, 0, -600, 600),
        patch("east", 800, 1500, -600, 600),
    )
    rng = np.random.default_rng(5)
    xy = np.concatenate([rng.uniform((0, -590), (800, 590), (120, 2)), rng.uniform((-690, -590), (0, 590), (80, 2))])
    xy[160:, 0] += 1500
    d = np.concatenate([np.zeros(120), rng.normal(0, 0.15, 80)])
    d[150] = 0.62
    kind = np.where(np.arange(200) < 120, "section", np.where(np.arange(200) < 170, "borehole", "outcrop"))
    points = PointSet(
        np.column_stack([xy, height(*xy.T) + d]) + ORIGIN,
        kind=kind,
        hole=np.where(kind == "borehole", [f"ZK{i}" for i in range(200)], ""),
        section=np.where(kind == "section", [f"S{i // 12 + 1}" for i in range(200)], ""),
        row=np.arange(200) + 2,
        file="剖面.csv" if chinese else "picks.csv",
    )
    core = np.arange(200) < 120
    where = np.array([p.name for p in patches])[np.select([core, np.arange(200) < 160], [0, 1], 2)]
    total = group(d)
    accuracy = Accuracy(
        n=200,
        sigma=total.sigma,
        epsilon=epsilon,
        passed=total.sigma < epsilon,
        max_abs=total.max_abs,
        mean=total.mean,
        residuals=d,
        patch=where,
        by_patch={w: group(d[where == w]) for w in ("core", "west", "east")},
        by_kind={k: group(d[kind == k]) for k in ("section", "borehole", "outcrop")},
        by_hole={},
        by_section={f"S{i + 1}": group(d[i * 12 : i * 12 + 12]) for i in range(10)},
        over={
            "interior_tolerance": Exceedance(0.1, int((np.abs(d) > 0.1).sum())),
            "epsilon": Exceedance(epsilon, int((np.abs(d) > epsilon).sum())),
        },
        worst=tuple(np.argsort(-np.abs(d), kind="stable")[:20].tolist()),
        seams=(Seam("core", "west", 0.0, 0.0002), Seam("core", "east", 2e-10, 0.0003)),
        checks=(
            Check(
                "normals",
                True,
                0.0,
                0.0,
                "places",
                message(
                    "checks.places-folded-count",
                    "{count} of {total} places folded or degenerate",
                    count=0,
                    total=90,
                ),
            ),
            Check(
                "above ground",
                None,
                float("nan"),
                float("nan"),
                "m",
                message("test.text", "no ground surface was given"),
            ),
        ),
        conflicts=(Conflict(130, 131, 0.8, message("test.text", "the borehole is more exact than the section")),),
    )
    corners = ((0.0, -600.0), (800.0, -600.0), (800.0, 600.0), (0.0, 600.0))
    surface = HorizonFit(
        surface=PatchSurface(patches, ORIGIN, name, frame="map"),
        points=points,
        settings=FitSettings(epsilon=epsilon),
        name=name,
        partition=Partition(
            tuple((x + ORIGIN[0], y + ORIGIN[1]) for x, y in corners),
            120,
            80,
            message("test.text", "Dense in the middle."),
        ),
        core=core,
        accuracy=accuracy,
        diagnostics={"smoothing": 0.0123, "frame": "map", "iterations": 3},
    )
    boundary = np.array([[-700.0, -600], [1500, -600], [1500, 600], [-700, 600]]) + ORIGIN[:2]
    site = Site(
        name="坝址" if chinese else "Dam site",
        horizons={name: points},
        boundary=boundary,
        holes=(Hole("ZK1", "borehole", np.array([0.0, 80]), np.add(ORIGIN, [[0.0, 0, 90], [10, 0, 10]])),),
        sections=(Section("S1", boundary[:2]),),
        issues=(
            ImportIssue(
                "picks.csv",
                7,
                "z",
                "abc",
                "error",
                message("test.text", "no number"),
                message("test.text", "write metres"),
            ),
            ImportIssue("picks.csv", 0, "", "", "note", message("test.text", "separator ';' was guessed")),
        ),
        counts=(TableCount("picks.csv", 201, 200, 1),),
        crs="CGCS2000 / 3-degree 105E",
        inputs={"picks.csv": "ab" * 32},
    )
    back = ReadBack(
        f"{name}.step", "cd" * 32, 3, total.sigma, 3e-9, total.max_abs, accuracy.seams, True, 8, 8, 1e-7,
        False,
        (Check("free edges", True, 8, 8, "", message("test.text", "all on the outline")),),
    )  # fmt: skip
    return HorizonResult(surface, site, back, equal_accuracy(surface, 0.1), 123_456, {"fit": 0.5, "pictures": 1.25})


def examined(result: HorizonResult) -> HorizonResult:
    """The same horizon with an examination away from its data: every figure by hand."""
    n = result.accuracy.n
    hole = result.surface.points.hole
    error = np.where(hole != "", 0.25, np.nan)

    def left_out(scheme, inside, rms):
        references = {"thin plate": 0.456, "kriging": 0.321}
        return LeftOut(scheme, 50, hole, error, np.full(n, 0.3), rms, 0.2, -0.015, 1.25, inside, 0.71, references)

    x, y = np.linspace(499_300, 501_500, 30), np.linspace(3_099_400, 3_100_600, 20)
    sd = 0.1 + 0.4 * np.hypot(*np.meshgrid(np.linspace(-1, 1, 30), np.linspace(-1, 1, 20)))
    field = Uncertainty(x, y, sd, 1.37, float(sd.mean()), float(sd.max()), np.full(sd.shape, 1.37))
    holes = (
        Suggestion(500_100.25, 3_099_900.5, 1503.0, 0.61, 0.31, 0.5),
        Suggestion(500_900.75, 3_100_100.5, 1520.0, 0.52, 0.27, 0.45),
    )
    found = PredictionResult(
        (left_out("hole", 0.904, 0.287), left_out("section", 0.612, 0.777)),
        field,
        holes,
        (Outlier(150, 0.91, 0.2, 4.5),),
        (
            message(
                "prediction.sections-indispensable",
                "without {failed} of the sections no surface can be fitted",
                failed=2,
            ),
        ),
    )
    return replace(result, prediction=found)
