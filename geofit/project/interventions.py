"""What a person did to a surface, for its report: points left out, and changes after the fit, in words."""

from __future__ import annotations

from geofit.data.messages import Message, message
from geofit.data.points import PointSet
from geofit.data.site import Site
from geofit.project.provenance import Apart, HandEdit, Move, Pull, Recipe

__all__ = ["interventions_of"]


def interventions_of(site: Site, recipe: Recipe) -> tuple[PointSet | None, tuple[Message, ...]]:
    """Return the points that a surface was fitted without, and its changes by hand in their order.

    Parameters
    ----------
    site : Site
        As it was read, with all points.
    recipe : Recipe
        What the surface was made from.

    Returns
    -------
    PointSet or None
        None if no point was left out; rows that the site does not have any more are passed over.
    tuple of Message
        One for each change.
    """
    points = site.horizons.get(recipe.part.horizon if recipe.part is not None else recipe.horizon)
    excluded = None
    if points is not None and recipe.excluded:
        found = sorted(index for row in recipe.excluded if (index := row.find(points)) is not None)
        excluded = points[found] if found else None
    return excluded, tuple(_in_words(edit) for edit in recipe.edits)


def _in_words(edit: HandEdit | Apart) -> Message:
    if isinstance(edit, Apart):
        return message(
            "edit.separated",
            "separated from {others} to at least {minimum:g} m",
            others=tuple(edit.sequence),
            minimum=edit.minimum,
        )
    if isinstance(edit, Move):
        return message(
            "edit.moved",
            "control point ({i}, {j}) of patch {patch} moved by {dz:+.3f} m",
            i=edit.i,
            j=edit.j,
            patch=edit.patch,
            dz=edit.dz,
        )
    if isinstance(edit, Pull):
        return message(
            "edit.pulled",
            "pulled towards point {number} by {share:.0f} % of its residual",
            number=edit.index + 1,
            share=100 * edit.share,
        )
    return message(
        "edit.weighed",
        "control point ({i}, {j}) of patch {patch} given the weight {weight:g}",
        i=edit.i,
        j=edit.j,
        patch=edit.patch,
        weight=edit.weight,
    )
