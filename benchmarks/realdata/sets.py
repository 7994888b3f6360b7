"""The real sets: read by geofit's own readers, as a person with these files would."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from geofit import FitSettings, PointSet
from geofit.data.site import Site
from geofit.io import Boreholes, Picks, read_boreholes, read_points, take_contacts

__all__ = ["SETS", "RealSet", "data_folder", "rectangle"]

#: Fewest holes that make a horizon of a set.
KIMBERLINA_WELLS, WEKA_HOLES = 30, 15
#: Share of Claudius' cloud that is given beside the section, by the file's own random number.
CLAUDIUS_SHARE = 0.2
#: Frequent codes of Copper Creek.
COPPER_CODES = ("pqd", "gdp", "GHv", "bx", "mgp", "gd")


@dataclass(frozen=True, eq=False)
class RealSet:
    """Horizons of one place, and how they are scored.

    Parameters
    ----------
    title : str
        Name in the table.
    site : Site
        What was read.
    given : str
        Which points were given, and which left out, in words.
    left_out : mapping of str to PointSet
        Points of a horizon that are not given at all; without them it is scored by ten folds.
    scale : FitSettings or None
        Tolerances of the set's own scale, for a second line of the table.
    """

    title: str
    site: Site
    given: str
    left_out: Mapping[str, PointSet] = field(default_factory=dict)
    scale: FitSettings | None = None


def data_folder() -> Path | None:
    """Return the folder of real data: ``GEOFIT_DATA``, else ``../shared/data``; None if it is not there."""
    stated = os.environ.get("GEOFIT_DATA")
    folder = Path(stated) if stated else Path(__file__).resolve().parents[3] / "shared" / "data"
    return folder if folder.is_dir() else None


def rectangle(xyz: np.ndarray) -> np.ndarray:
    """Return the four corners (4, 2) of the map rectangle around points."""
    (x0, y0), (x1, y1) = xyz[:, :2].min(axis=0), xyz[:, :2].max(axis=0)
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def _alone(picks: Picks) -> PointSet:
    (points,) = picks.horizons.values()
    return points


def _site(name: str, horizons: Mapping[str, PointSet], *read: Picks | Boreholes, **more: object) -> Site:
    inputs = {file: digest for part in read for file, digest in (part.inputs or {}).items()}
    issues = tuple(issue for part in read for issue in part.issues)
    counts = tuple(count for part in read for count in part.counts)
    return Site(name, horizons, issues=issues, counts=counts, inputs=inputs, **more)


def _claudius(folder: Path) -> RealSet:
    horizons, left_out, read = {}, {}, []
    for name in "AC":
        cloud = read_points(folder / "claudius" / f"{name}Points.csv")
        drawn = read_points(folder / "claudius" / f"{name}Points.csv", z="Cutoff")
        line = read_points(folder / "claudius" / f"{name}Section.csv")
        given = _alone(drawn).xyz[:, 2] < CLAUDIUS_SHARE
        horizons[name] = PointSet.concatenate([_alone(line), _alone(cloud)[given]])
        rest = _alone(cloud)[~given]
        known = {tuple(place) for place in horizons[name].xyz[:, :2]}
        left_out[name] = rest[[tuple(place) not in known for place in rest.xyz[:, :2]]]
        read += [cloud, line]
    both = np.concatenate([part.xyz for part in (*horizons.values(), *left_out.values())])
    site = _site("Claudius", horizons, *read, boundary=rectangle(both))
    given_words = f"the section and the cloud's points with Cutoff < {CLAUDIUS_SHARE:g}; the rest of the cloud left out"
    return RealSet("Claudius", site, given_words, left_out)


def _muensterland(folder: Path) -> RealSet:
    picks = read_points(folder / "muensterland" / "base_cretaceous.csv")
    site = _site("Münsterland", {"base of the Cretaceous": _alone(picks)}, picks)
    return RealSet("Münsterland", site, "all points", scale=FitSettings(epsilon=25.0, interior_tolerance=20.0))


def _chamaya(folder: Path) -> RealSet:
    wells = {name: read_points(folder / "chamaya" / "Wells.dat", z=name[:3]) for name in ("top", "bottom")}
    site = _site("Chamaya", {name: _alone(picks) for name, picks in wells.items()}, *wells.values())
    return RealSet("Chamaya", site, "all wells")


def _kimberlina(folder: Path) -> RealSet:
    table = folder / "kimberlina" / "kim_ready.csv"
    depth = read_points(table, z="base", surface="formation")
    altitude = read_points(table, z="altitude", surface="formation")
    mouth = {
        row: z for points in altitude.horizons.values() for row, z in zip(points.row, points.xyz[:, 2], strict=True)
    }
    horizons = {}
    for name, points in depth.horizons.items():
        if len(np.unique(points.hole)) >= KIMBERLINA_WELLS:
            xyz = points.xyz.copy()
            xyz[:, 2] = [mouth[row] - z for row, z in zip(points.row, xyz[:, 2], strict=True)]
            horizons[f"base of {name}"] = points.with_(xyz=xyz, kind="borehole")
    site = _site("Kimberlina", horizons, depth)
    words = f"all wells; elevation = altitude - base; formations with at least {KIMBERLINA_WELLS} wells"
    return RealSet("Kimberlina", site, words)


def _limits(holes: Boreholes) -> dict[str, PointSet]:
    """Return the top and the base of every code, the code with most intervals first."""
    codes, count = np.unique(np.concatenate([log.code for log in holes.logs]), return_counts=True)
    limits = {}
    for code in codes[np.argsort(-count, kind="stable")].tolist():
        limits[f"top of {code}"] = take_contacts(holes, top=code).points
        limits[f"base of {code}"] = take_contacts(holes, base=code).points
    return limits


def _weka_hills(folder: Path) -> RealSet:
    path = folder / "weka_hills"
    holes = read_boreholes(path / "Location.csv", intervals=[path / "Geol.csv"])
    horizons = {name: points for name, points in _limits(holes).items() if len(points) >= WEKA_HOLES}
    site = _site("Weka Hills", horizons, holes, holes=holes.holes)
    return RealSet("Weka Hills", site, f"contacts seen by at least {WEKA_HOLES} holes, all given")


def _copper_creek(folder: Path) -> RealSet:
    path = folder / "copper_creek"
    holes = read_boreholes(path / "collar.csv", path / "survey.csv", [path / "lithology.csv"])
    limits, names = _limits(holes), [f"{end} of {code}" for code in COPPER_CODES for end in ("top", "base")]
    site = _site("Copper Creek", {name: limits[name] for name in names}, holes, holes=holes.holes)
    words = f"tops and bases of {len(COPPER_CODES)} frequent codes, all contacts given"
    return RealSet("Copper Creek", site, words)


SETS: dict[str, Callable[[Path], RealSet]] = {
    "copper_creek": _copper_creek,
    "kimberlina": _kimberlina,
    "weka_hills": _weka_hills,
    "muensterland": _muensterland,
    "claudius": _claudius,
    "chamaya": _chamaya,
}
