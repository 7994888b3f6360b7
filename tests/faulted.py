"""A truth with a fault: a horizon that an inclined normal fault throws down, with the throw known everywhere."""

from __future__ import annotations

import numpy as np
from shapely import Polygon, contains_xy
from truth import EASTING, NORTHING, hills

from geofit import FitSettings, PointSet
from geofit.data.site import Site

ORIGIN = np.array([EASTING, NORTHING])
BOUNDARY = np.array([[0, 0], [1200, 0], [1200, 1000], [0, 1000]]) + ORIGIN
HEIGHT = hills(7, size=1200.0, shortest=400.0, relief=4.0)
#: The fault's trace at the elevation 1500 m in plan, local; the part on its left is thrown down.
START, WAY = np.array([520.0, 0.0]), np.array([0.12, 1.0]) / np.hypot(0.12, 1.0)
ACROSS = np.array([-WAY[1], WAY[0]])
DIP = np.radians(75.0)


def throw(along):
    """5 m, growing by 2 m a kilometre along the fault."""
    return 5.0 + 0.002 * along


def off(x, y, z):
    """Distance in plan from the fault at its elevation, positive on the left, the hanging wall."""
    return (np.column_stack([x, y]) - ORIGIN - START) @ ACROSS + (z - 1500.0) / np.tan(DIP)


def truth(x, y):
    """The faulted horizon: the left block, which lies over the fault, is down."""
    along = (np.column_stack([x, y]) - ORIGIN - START) @ WAY
    z = HEIGHT(x, y)
    down = z - throw(along)
    return np.where(off(x, y, (z + down) / 2) > 0, down, z)


def fault_points():
    """Points of the fault's plane: it dips to the left."""
    along, depth = np.meshgrid(np.linspace(-100, 1200, 14), np.linspace(-70, 70, 6))
    plan = START + along.ravel()[:, None] * WAY - (depth.ravel() / np.tan(DIP))[:, None] * ACROSS
    return PointSet(np.column_stack([plan + ORIGIN, 1500.0 + depth.ravel()]))


def horizon_points():
    """Points of the horizon on both sides."""
    rng = np.random.default_rng(11)
    wide = rng.uniform(BOUNDARY[0], BOUNDARY[2], (360, 2))
    # Holes beside the fault, as one drills them where one looks for it.
    beside = (
        np.sort(rng.uniform(10, 990, 60))[:, None] * WAY
        + (rng.uniform(4, 15, 60) * np.tile([1, -1], 30))[:, None] * ACROSS
    )
    plan = np.concatenate([wide, beside + START + ORIGIN])
    # In the heave there is no horizon at all.
    plan = plan[np.abs(off(*plan.T, truth(*plan.T))) > 2.0]
    return PointSet(np.column_stack([plan, truth(*plan.T)]), file="holes.csv", row=np.arange(len(plan)) + 2)


def faulted_site():
    """The horizon and its fault as a site states them."""
    return Site(
        "site",
        {"T2": horizon_points(), "F1": fault_points()},
        settings={"F1": FitSettings(frame="best-plane")},
        boundary=BOUNDARY,
        faults={"F1": ("T2",)},
    )


#: An area of two arms.
ARMS = np.array([[0, 0], [1000, 0], [1000, 400], [400, 400], [400, 600], [1000, 600], [1000, 1000], [0, 1000.0]])


def armed_points(keep=lambda x, y: np.full(len(x), True)):
    """A horizon over an area of two arms, thrown by 20 m along a trace that cuts both."""
    x, y = np.random.default_rng(11).uniform(0, 1000, (2, 240))
    z = 20 * np.sin(x / 200) + 10 * np.cos(y / 150) - np.where(x > 450 + 0.1 * y, 20, 0)
    mine = contains_xy(Polygon(ARMS), x, y) & keep(x, y)
    return PointSet(np.column_stack([x, y, z])[mine])


def armed_site():
    """Such a horizon, "T2", with its fault "F1" upright through both arms."""
    y, z = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 1000, 12), np.linspace(-100, 100, 5)))
    fault = PointSet(np.column_stack([450 + 0.1 * y, y, z]), file="f.csv", row=np.arange(len(y)))
    points = armed_points()
    horizons = {"T2": points.with_(file="t.csv", row=np.arange(len(points))), "F1": fault}
    settings = {"F1": FitSettings(frame="best-plane")}
    return Site("Arms", horizons, settings=settings, boundary=ARMS, faults={"F1": ("T2",)})
