"""Turns a site and its surfaces into layers. It knows the data, not the window."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from geofit.data.points import PointSet
from geofit.data.prediction import Suggestion, Uncertainty
from geofit.data.settings import FitSettings
from geofit.data.site import Ground, Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.view3d.cloud import PointCloud
from geofit.gui.view3d.drawn import Drawn, drawn_of
from geofit.gui.view3d.horizon_items import (
    control_item,
    place_control,
    points_item,
    seams_item,
    shape_item,
    suggestions_item,
)
from geofit.gui.view3d.item import Item, Look
from geofit.gui.view3d.layers import Layer
from geofit.gui.view3d.moved_region import MovedRegion
from geofit.gui.view3d.shape import next_below, seam_lines, too_coarse
from geofit.gui.view3d.sight import Sight
from geofit.gui.view3d.site_items import boundary_item, dips_item, ground_item, holes_item, sections_item
from geofit.gui.view3d.stage import Stage
from geofit.project.listing import Listing
from geofit.report.style import horizon_colours
from geofit.site.hole_logs import log_files
from geofit.surfaces.below_ground import below_ground

__all__ = ["Contents"]

Floats = NDArray[np.float64]

#: So many points are drawn in every view; of more, as many as it has room for.
FEW = 10_000


class Contents:
    """What the scene shows: at most one site, and the surfaces of its horizons (or of none)."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.site: Site | None = None
        self.points: dict[str, PointSet] = {}
        self.surfaces: dict[str, HorizonFit] = {}
        self.control: dict[str, list[tuple[str, int, int]]] = {}
        self.drawn: dict[str, Drawn] = {}
        self.listed: dict[str, Listing] = {}
        self.faded = True
        self._clouds: list[PointCloud] = []
        self._cut: dict[str, MovedRegion] = {}

    def set_faded(self, on: bool) -> None:
        """Fade what lies above the ground or beyond the points of its surface, or draw it in full."""
        if on != self.faded:
            self.faded = on
            for name in self.surfaces:
                self.stage.rebuild(f"surface:{name}")

    def show_listing(self, name: str, listing: Listing) -> None:
        """Show all points of a horizon, excluded ones as ghosts, with their residuals."""
        if self.listed.get(name) is not listing:
            self.listed[name] = listing
            self._show_points(name)

    def show_site(self, site: Site) -> None:
        """Show a site in place of the one before; surfaces of horizons that it does not have are removed."""
        for name in [*self.points, *self.surfaces]:
            if name not in site.horizons:
                self.remove_surface(name)
                self.stage.layers.remove(f"points:{name}")
        self.site, self.points = site, dict(site.horizons)
        level = self._level()
        boreholes = [hole for hole in site.holes if hole.kind == "borehole"]
        adits = [hole for hole in site.holes if hole.kind == "adit"]
        if site.ground is not None:
            ground = site.ground
            self.stage.show(Layer("ground", "ground", opacity=0.3), lambda a, b: ground_item(ground, a, b))
        if site.boundary is not None and len(site.boundary):
            rim = site.boundary
            self.stage.show(Layer("boundary", "boundary"), lambda a, b: boundary_item(rim, site.ground, level, a, b))
        for key, holes in (("holes", boreholes), ("adits", adits)):
            if holes:
                logged = log_files(site) if key == "holes" else ()
                layer = Layer(key, key, labels=True, choices=("plain", *logged), colour_by=(*logged, "plain")[0])
                self.stage.show(layer, partial(holes_item, holes, site))
        if site.sections:
            self.stage.show(
                Layer("sections", "sections", labels=True),
                lambda a, b: sections_item(site.sections, site.ground, level, a, b),
            )
        if (dips := site.orientations) is not None and len(dips):
            width = float(np.ptp(self.everything(), axis=0).max())
            self.stage.show(Layer("dips", "dips", labels=False), lambda a, b: dips_item(dips, width, a, b))
        present = {
            "ground": site.ground is not None,
            "boundary": site.boundary is not None and len(site.boundary) > 0,
            "holes": bool(boreholes),
            "adits": bool(adits),
            "sections": bool(site.sections),
            "dips": dips is not None and len(dips) > 0,
        }
        for key, there in present.items():
            if not there:
                self.stage.layers.remove(key)
        for name in site.horizons:
            self._show_points(name)
        for layer in self.stage.layers:
            if layer.colour:
                self.stage.layers.change(layer.key, colour=self.colour(layer.horizon))

    def show_surface(
        self, surface: HorizonFit, uncertainty: Uncertainty | None = None, drawn: Drawn | None = None
    ) -> None:
        """Show a surface, or its new fit; ``drawn`` if it was made ready already."""
        name, layers = surface.name, self.stage.layers
        drawn = drawn or drawn_of(surface, uncertainty, None if self.site is None else self.site.ground)
        self.surfaces[name], self.drawn[name] = surface, drawn
        self._cut.pop(name, None)
        self.points.setdefault(name, surface.points)
        colour = self.colour(name)
        choices = ["plain", "elevation", "dip", "thickness"] + ["standard deviation"] * (drawn.sd is not None)
        self.stage.show(
            Layer(f"surface:{name}", "surface", name, colour, choices=tuple(choices), isolines=False),
            lambda layer, look: shape_item(
                self.drawn[name].shape,
                self._values(name, layer.colour_by),
                layer,
                look,
                self.drawn[name].supported if self.faded else None,
                self._cut.get(name),
                self.drawn[name].largest_sd if layer.colour_by == "standard deviation" else None,
            ),
        )
        for kind, bound in (("upper", drawn.upper), ("lower", drawn.lower)):
            if bound is None:
                layers.remove(f"{kind}:{name}")
            else:
                layer = Layer(f"{kind}:{name}", kind, name, colour, visible=False, opacity=0.35)
                self.stage.show(layer, partial(shape_item, bound, None))
        self._show_points(name)
        for key, show in ((f"seams:{name}", self.show_seams), (f"control:{name}", self.show_control)):
            if key in layers or key in layers.kept:
                show(name)
        for layer in layers:
            if layer.colour_by == "thickness" and layer.horizon != name:
                self.stage.rebuild(layer.key)

    def too_coarse(self, sight: Sight) -> list[str]:
        """Return the horizons whose surfaces, as far as they are drawn, need more triangles for a view."""
        shown = [layer.horizon for layer, _ in self.stage.items() if layer.kind == "surface"]
        return [name for name in shown if too_coarse(self.surfaces[name], sight, self.drawn[name].sight)]

    def sharpen(self, surface: HorizonFit, drawn: Drawn) -> None:
        """Draw a surface that is shown with other triangles; another fit, or one being dragged, stays as it is."""
        if self.surfaces.get(surface.name) is surface and surface.name not in self._cut:
            self.drawn[surface.name] = drawn
            self.stage.rebuild(f"surface:{surface.name}")

    def remove_surface(self, name: str) -> None:
        """Take away a surface with all that belongs to it; its points stay if they are of the site."""
        for kind in ("surface", "upper", "lower", "seams", "control", "suggestions"):
            self.stage.layers.remove(f"{kind}:{name}")
        for known in (self.surfaces, self.drawn, self.control, self._cut):
            known.pop(name, None)
        if self.site is not None and name in self.site.horizons:
            self._show_points(name)
        else:
            self.points.pop(name, None)
            self.listed.pop(name, None)
            self.stage.layers.remove(f"points:{name}")

    def clear(self, *, keep: bool = False) -> None:
        """Take everything away; ``keep`` what was chosen for the layers."""
        self.site = None
        for known in (self.points, self.surfaces, self.drawn, self.control, self.listed, self._cut):
            known.clear()
        self._clouds.clear()
        self.stage.layers.clear(keep=keep)

    def show_seams(self, name: str) -> None:
        """Show the seams of a surface that has been checked."""
        surface = self.surfaces[name]
        seams = surface.accuracy.seams if surface.accuracy is not None else ()
        if not seams:
            self.stage.layers.remove(f"seams:{name}")
            return
        runs = seam_lines(surface, seams)
        layer = Layer(f"seams:{name}", "seams", name, choices=("angle", "gap"), colour_by="angle")
        self.stage.show(layer, lambda a, b: seams_item(runs, seams, a, b))

    def seam_place(self, name: str, index: int) -> tuple[float, float, float] | None:
        """Return the middle of a seam's longest line inside the study area; None where the scene has no such seam."""
        surface = self.surfaces.get(name)
        seams = surface.accuracy.seams if surface is not None and surface.accuracy is not None else ()
        if surface is None or not 0 <= index < len(seams):
            return None
        runs = seam_lines(surface, seams[index : index + 1])[0]
        if not runs:
            return None
        x, y, z = max(runs, key=len)[len(max(runs, key=len)) // 2].tolist()
        return x, y, z

    def show_control(self, name: str) -> None:
        """Show the control points of a surface."""
        if not self.surfaces[name].patches:
            self.stage.layers.remove(f"control:{name}")
            return

        def build(layer: Layer, look: Look) -> Item:
            item, self.control[name] = control_item(self.surfaces[name], layer, look)
            return item

        self.stage.show(Layer(f"control:{name}", "control", name), build)

    def cut_out(self, name: str, region: MovedRegion | None) -> None:
        """Leave out of a surface what a control point moves just now; None: draw the whole surface."""
        if region is not self._cut.get(name):
            if region is None:
                del self._cut[name]
            else:
                self._cut[name] = region
            self.stage.rebuild(f"surface:{name}")

    def place_control(self, name: str, xyz: Floats) -> None:
        """Put the control points of a surface elsewhere, (n, 3) map coordinates, until it is shown anew."""
        for layer, item in self.stage.items():
            if layer.key == f"control:{name}":
                place_control(item, xyz, self.stage.look)

    def show_suggestions(self, name: str, suggestions: tuple[Suggestion, ...]) -> None:
        """List where the next holes should stand; they are seen when somebody asks for them."""
        key = f"suggestions:{name}"
        if suggestions:
            top = float(self.everything()[:, 2].max())
            layer = Layer(key, "suggestions", name, visible=False, labels=True)
            self.stage.show(layer, lambda a, b: suggestions_item(suggestions, top, a, b))
        else:
            self.stage.layers.remove(key)

    def colour(self, name: str) -> str:
        """Return the colour of a horizon, as everywhere; those that the site does not have come after its own."""
        site = self.site
        names, blocks = ((), {}) if site is None else (site.horizons, site.blocks)
        return horizon_colours([*names, *self.points], blocks)[name]

    def residuals(self, name: str) -> Floats | None:
        """Return the residuals of a horizon's points, None where it has no checked surface of these points."""
        listed, surface = self.listed.get(name), self.surfaces.get(name)
        if listed is not None and listed.points is self.points.get(name):
            return listed.residual if np.isfinite(listed.residual).any() else None
        accuracy = surface.accuracy if surface is not None else None
        if accuracy is None or len(accuracy.residuals) != len(self.points[name]):
            return None
        return accuracy.residuals

    def everything(self) -> Floats:
        """Return the corners of all that is known, (n, 3) map coordinates; empty if nothing is."""
        found = [np.stack([p.xyz.min(axis=0), p.xyz.max(axis=0)]) for p in self.points.values() if len(p)]
        found += [drawn.shape.xyz for drawn in self.drawn.values()]
        if self.site is not None:
            found += [hole.xyz for hole in self.site.holes]
            if (ground := self.site.ground) is not None:
                ends = np.array([0, -1])
                z = np.array([np.nanmin(ground.z), np.nanmax(ground.z)])
                found.append(np.column_stack([ground.x[ends], ground.y[ends], z]))
        return np.concatenate(found) if found else np.empty((0, 3))

    def _level(self) -> float:
        known = self.everything()
        return float(known[:, 2].max()) if len(known) else 0.0

    def _show_points(self, name: str) -> None:
        listed = self.listed.get(name)
        points = self.points[name] if listed is None else listed.points
        self.points[name] = points
        if not len(points):
            self.stage.layers.remove(f"points:{name}")
            return
        surface = self.surfaces.get(name)
        if listed is None and surface is not None and len(surface.points) == len(points):
            points = self.points[name] = surface.points
        residuals = self.residuals(name)
        settings = surface.settings if surface is not None else FitSettings()
        choices = ("kind", *(("deviation",) if residuals is not None else ()), "elevation", "plain")
        layer = Layer(f"points:{name}", "points", name, self.colour(name), choices=choices, colour_by="kind")
        excluded = None if listed is None else listed.excluded
        self.stage.show(
            layer, lambda a, b: points_item(points, residuals, settings, a, b, excluded, self._cloud(points.xyz))
        )

    def _cloud(self, xyz: Floats) -> PointCloud | None:
        """Return many points in blocks; they are sorted once, whoever shows them."""
        if len(xyz) <= FEW:
            return None
        known = {id(points.xyz) for points in self.points.values()}
        self._clouds = [cloud for cloud in self._clouds if id(cloud.xyz) in known]
        for cloud in self._clouds:
            if cloud.xyz is xyz:
                return cloud
        self._clouds.append(PointCloud.of(xyz))
        return self._clouds[-1]

    def _values(self, name: str, by: str) -> tuple[Floats, Floats] | None:
        """Return what a surface is coloured by, at the vertices of its fine and coarse triangles."""
        fine = self.drawn[name].shape
        coarse = fine.coarse or fine
        if by == "elevation":
            return fine.xyz[:, 2], coarse.xyz[:, 2]
        if by == "dip":
            return fine.dip, coarse.dip
        if by == "standard deviation":
            return self.drawn[name].sd
        if by == "thickness":
            below = next_below(self.surfaces[name], coarse, list(self.surfaces.values()))
            if below is not None:
                ground = None if self.site is None else self.site.ground
                return _thickness(fine.xyz, below, ground), _thickness(coarse.xyz, below, ground)
        return None


def _thickness(xyz: Floats, below: HorizonFit, ground: Ground | None) -> Floats:
    """Return how thick the rock under a surface's vertices (n, 3) is down to the horizon below, metres."""
    x, y, z = xyz.T
    return np.asarray(below_ground(z, x, y, ground) - below_ground(below.elevation(x, y), x, y, ground))
