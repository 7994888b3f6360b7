"""Picks of a rule in a scene, before they are a horizon of the site."""

from __future__ import annotations

from geofit.gui.view3d.view import SceneView
from geofit.project.horizon_builder import RulePicks
from geofit.project.listing import listing

__all__ = ["show_picks"]


def show_picks(view: SceneView, name: str, picks: RulePicks | None) -> None:
    """Show picks as the points of a horizon of that name, or take them away where there are none."""
    if picks is None or not len(picks.points):
        view.remove_surface(name)
    else:
        view.show_listing(name, listing(picks.points, frozenset(), None))
