"""Programs that make a surface of scattered points, each with its usual settings, as functions of one shape.

A tool takes points (n, 3) and returns a function of places (m, 2) that gives elevations (m,), and how many numbers hold
its surface. Every import is inside: geofit and OpenCASCADE live in one environment, the other programs in another.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

__all__ = ["TOOLS", "Tool"]

Elevation = Callable[[np.ndarray], np.ndarray]
Made = tuple[Elevation, int]


@dataclass(frozen=True)
class Tool:
    """A program: what it is called, its power of n in time, whether it needs points on a grid, and who installs it."""

    title: str
    power: int
    make: Callable[[np.ndarray], Made]
    grid: bool = False
    own: bool = False


def geofit(xyz: np.ndarray) -> Made:
    from geofit import FitSettings, PointSet, fit_horizon

    low, high = xyz[:, :2].min(axis=0), xyz[:, :2].max(axis=0)
    corners = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
    surface = fit_horizon(PointSet(xyz), FitSettings(core="none"), corners)
    return lambda places: surface.elevation(*places.T), surface.control_points


def geofit_cloud(xyz: np.ndarray) -> Made:
    from geofit.streaming.fit import fit_cloud

    surface = fit_cloud(xyz).surface
    count = sum(patch.control.shape[0] * patch.control.shape[1] for patch in surface.patches)
    return lambda places: surface.elevation(*places.T), count


def geomplate(xyz: np.ndarray) -> Made:
    from geofit import PointSet
    from peers.geomplate import geom_plate

    surface = geom_plate(PointSet(xyz))
    return lambda places: surface.elevation(*places.T), surface.control_points


def thin_plate(xyz: np.ndarray) -> Made:
    from scipy.interpolate import RBFInterpolator

    spline = RBFInterpolator(_scaled(xyz)(xyz[:, :2]), xyz[:, 2], kernel="thin_plate_spline")
    scaled = _scaled(xyz)
    return lambda places: spline(scaled(places)), len(xyz) + 3


def p_spline(xyz: np.ndarray) -> Made:
    from peers.pspline import PSpline

    low, high = xyz[:, :2].min(axis=0), xyz[:, :2].max(axis=0)
    spans = int(np.clip(np.sqrt(len(xyz)), 4, 60))
    spline = PSpline((low[0], high[0], low[1], high[1]), spans, 0.01).fit(xyz)
    inside = lambda places: np.clip(places, low, high)  # noqa: E731
    return lambda places: spline.elevation(*inside(places).T), spline.count**2


def least_squares_spline(xyz: np.ndarray) -> Made:
    from scipy.interpolate import LSQBivariateSpline

    plan = _scaled(xyz)(xyz[:, :2])
    inner = np.linspace(0, 1, int(np.clip(np.sqrt(len(xyz)) / 2, 2, 60)) + 2)[1:-1]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a rank that is not full: few points between some knots
        spline = LSQBivariateSpline(*plan.T, xyz[:, 2], inner, inner)
    scaled = _scaled(xyz)
    return lambda places: spline.ev(*scaled(places).T), len(spline.get_coeffs())


def verde(xyz: np.ndarray) -> Made:
    import verde as vd

    spacing = float(np.ptp(xyz[:, 0])) / 45
    blocks = [("mean", vd.BlockReduce(np.mean, spacing))] if len(xyz) > 2_000 else []
    chain = vd.Chain([*blocks, ("trend", vd.Trend(1)), ("spline", vd.Spline(damping=1e-8))])
    chain.fit((xyz[:, 0], xyz[:, 1]), xyz[:, 2])
    count = len(chain.named_steps["spline"].force_) + 3
    return lambda places: chain.predict((places[:, 0], places[:, 1])), count


def pykrige(xyz: np.ndarray) -> Made:
    from pykrige.ok import OrdinaryKriging

    x, y = _scaled(xyz)(xyz[:, :2]).T
    kriging = OrdinaryKriging(x, y, xyz[:, 2], variogram_model="spherical")
    scaled = _scaled(xyz)
    return lambda places: np.asarray(kriging.execute("points", *scaled(places).T)[0]), len(xyz)


def gstools(xyz: np.ndarray) -> Made:
    import gstools as gs

    x, y = _scaled(xyz)(xyz[:, :2]).T
    model = gs.Matern(dim=2, nu=2.5)
    kriging = gs.krige.Universal(
        model, (x, y), xyz[:, 2], drift_functions="linear", fit_variogram=True, exact=False, cond_err="nugget"
    )
    scaled = _scaled(xyz)
    return lambda places: kriging(scaled(places).T, return_var=False), len(xyz)


def gaussian_process(xyz: np.ndarray) -> Made:
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

    plan, mean, deviation = _scaled(xyz)(xyz[:, :2]), xyz[:, 2].mean(), xyz[:, 2].std()
    kernel = ConstantKernel() * Matern(0.3, nu=2.5) + WhiteKernel(1e-4, (1e-8, 1.0))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of parameters at their bounds
        process = GaussianProcessRegressor(kernel).fit(plan, (xyz[:, 2] - mean) / deviation)
    scaled = _scaled(xyz)
    return lambda places: mean + deviation * process.predict(scaled(places)), len(xyz)


def geomdl(xyz: np.ndarray) -> Made:
    from geomdl import fitting

    size = round(len(xyz) ** 0.5)
    control = max(size // 2, 4)
    low = xyz.min(axis=0)
    surface = fitting.approximate_surface(
        (xyz - low).tolist(), size, size, 3, 3, ctrlpts_size_u=control, ctrlpts_size_v=control, centripetal=False
    )
    side = np.ptp(xyz[:, :2], axis=0)

    def elevation(places: np.ndarray) -> np.ndarray:
        # On a grid x and y are nearly the parameters themselves; a few corrections find those of a place.
        goal = (places - low[:2]) / side
        at = goal.copy()
        for _ in range(6):
            found = np.array(surface.evaluate_list(np.clip(at, 0, 1).tolist()))
            at += goal - found[:, :2] / side
        return found[:, 2] + low[2]

    return elevation, surface.ctrlpts_size


def _scaled(xyz: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    low, size = xyz[:, :2].min(axis=0), float(np.ptp(xyz[:, :2], axis=0).max())
    return lambda places: (places - low) / size


TOOLS = {
    "geofit": Tool("geofit", 1, geofit, own=True),
    "geofit_cloud": Tool("geofit, `fit_cloud`", 1, geofit_cloud, own=True),
    "geomplate": Tool("OpenCASCADE GeomPlate", 2, geomplate, own=True),
    "thin_plate": Tool("scipy thin plate", 3, thin_plate),
    "p_spline": Tool("plain P-spline", 1, p_spline),
    "least_squares": Tool("LSQBivariateSpline", 2, least_squares_spline),
    "verde": Tool("verde", 1, verde),
    "pykrige": Tool("pykrige", 3, pykrige),
    "gstools": Tool("GSTools", 3, gstools),
    "gaussian_process": Tool("scikit-learn GP", 3, gaussian_process),
    "geomdl": Tool("geomdl", 2, geomdl, grid=True),
}
