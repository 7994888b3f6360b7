"""What is known of a thing of a site, in a few lines: a point, a hole at a depth, a surface at a place."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, Untranslated, message
from geofit.data.points import PointSet
from geofit.data.prediction import Uncertainty
from geofit.data.site import Hole, Site
from geofit.fitting.horizon_fit import HorizonFit

__all__ = ["hole_lines", "point_lines", "surface_lines"]

Floats = NDArray[np.float64]

#: Standard deviations to each side that hold 90 %; half the step over which the dip is measured, metres.
WIDTH, STEP = 1.6448536269514722, 0.5


def point_lines(
    horizon: str, points: PointSet, index: int, residual: float | None = None, *, excluded: bool = False
) -> tuple[Message, ...]:
    """Return what is known of a data point: source, file and row, elevation, residual (m)."""
    x, y, z = points.xyz[index].tolist()
    lines = [
        message(
            "project.identified-point",
            "{horizon}: {point}",
            horizon=Untranslated(horizon),
            point=points.describe(index),
        ),
        message("project.identified-place", "E {x:.2f}  N {y:.2f}  Z {z:.2f} m", x=x, y=y, z=z),
    ]
    if excluded:
        lines.append(message("project.identified-excluded", "excluded from the fit"))
    elif residual is not None and np.isfinite(residual):
        lines.append(message("project.identified-residual", "residual {d:+.3f} m", d=residual))
    if np.isfinite(points.accuracy[index]):
        lines.append(
            message("project.identified-accuracy", "stated accuracy {value:g} m", value=float(points.accuracy[index]))
        )
    return tuple(lines)


def hole_lines(site: Site, name: str, xyz: Floats | None = None) -> tuple[Message, ...]:
    """Return what is known of a hole or adit; with a place on it also the depth and what was logged there."""
    hole = next((one for one in site.holes if one.name == name), None)
    if hole is None:
        return ()
    length = float(hole.depth[-1])
    lines = [
        message("project.identified-hole", "{kind} {name}, {length:.1f} m", kind=hole.kind, name=Untranslated(name),
                length=length),
        message("project.identified-collar", "from E {x:.2f}  N {y:.2f}  Z {z:.2f} m", x=float(hole.xyz[0, 0]),
                y=float(hole.xyz[0, 1]), z=float(hole.xyz[0, 2])),
    ]  # fmt: skip
    if xyz is not None:
        depth = _depth(hole, xyz)
        lines.append(message("project.identified-depth", "here {depth:.1f} m along it", depth=depth))
        for campaign in site.boreholes:
            for log in campaign.logs:
                here = (log.hole == name) & (log.top <= depth) & (log.base > depth)
                if here.any():
                    code = str(log.code[here][0])
                    lines.append(
                        message("project.identified-logged", "{code} in {file}", code=Untranslated(code),
                                file=Untranslated(log.file))
                    )  # fmt: skip
    contacts = [horizon for horizon, points in site.horizons.items() if (points.hole == name).any()]
    if contacts:
        lines.append(
            message("project.identified-contacts", "contacts of {names}", names=tuple(map(Untranslated, contacts)))
        )
    return tuple(lines)


def surface_lines(surface: HorizonFit, xyz: Floats, uncertainty: Uncertainty | None = None) -> tuple[Message, ...]:
    """Return what is known of a surface at a place on it: elevation, dip, 90 % band where it was examined."""
    x, y, z = (float(value) for value in xyz)
    lines = [
        message("project.identified-surface", "{name}: surface", name=Untranslated(surface.name)),
        message("project.identified-place", "E {x:.2f}  N {y:.2f}  Z {z:.2f} m", x=x, y=y, z=z),
    ]
    if surface.frame in ("map", ""):
        east, west, north, south = surface.elevation(
            np.array([x + STEP, x - STEP, x, x]), np.array([y, y, y + STEP, y - STEP])
        ).tolist()
        slope = np.array([east - west, north - south]) / (2 * STEP)
        if np.isfinite(slope).all():
            dip = float(np.degrees(np.arctan(np.hypot(*slope))))
            azimuth = float(np.degrees(np.arctan2(-slope[0], -slope[1]))) % 360
            lines.append(
                message("project.dip-towards", "dip {dip:.0f}° towards {azimuth:03.0f}°", dip=dip, azimuth=azimuth)
            )
        if uncertainty is not None and uncertainty.frame == "map":
            i, j = (int(np.abs(axis - value).argmin()) for axis, value in ((uncertainty.x, x), (uncertainty.y, y)))
            half = WIDTH * float(np.hypot(uncertainty.sd[j, i], uncertainty.noise))
            if np.isfinite(half):
                lines.append(
                    message("project.identified-band", "a new hole meets it within ± {half:.2f} m (90 %)", half=half)
                )
    return tuple(lines)


def _depth(hole: Hole, xyz: Floats) -> float:
    """Return the depth along a hole that is nearest to a place, metres."""
    start, way = hole.xyz[:-1], np.diff(hole.xyz, axis=0)
    share = (((xyz - start) * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-12)).clip(0, 1)
    k = int(np.linalg.norm(start + share[:, None] * way - xyz, axis=1).argmin())
    return float(hole.depth[k] + share[k] * (hole.depth[k + 1] - hole.depth[k]))
