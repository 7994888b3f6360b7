"""What a person did to a surface, for its report: points left out, and changes after the fit, in words."""

from __future__ import annotations

from geofit.data.messages import Message, message
from geofit.data.points import PointSet
from geofit.data.site import Site
from geofit.project.provenance import ManualEdit, Move, MoveToPointEdit, Provenance, SeparationEdit

__all__ = ["interventions_of"]


def interventions_of(site: Site, provenance: Provenance) -> tuple[PointSet | None, tuple[Message, ...]]:
    """Return the points that a surface was fitted without, and its manual edits in their order.

    Parameters
    ----------
    site : Site
        As it was read, with all points.
    provenance : Provenance
        What the surface was made from.

    Returns
    -------
    PointSet or None
        None if no point was left out; rows that the site does not have any more are passed over.
    tuple of Message
        One for each change.
    """
    points = site.horizons.get(provenance.part.horizon if provenance.part is not None else provenance.horizon)
    excluded = None
    if points is not None and provenance.excluded:
        found = sorted(index for row in provenance.excluded if (index := row.find(points)) is not None)
        excluded = points[found] if found else None
    return excluded, tuple(_in_words(edit) for edit in provenance.edits)


def _in_words(edit: ManualEdit | SeparationEdit) -> Message:
    if isinstance(edit, SeparationEdit):
        return message(
            "project.separated",
            "separated from {others} to at least {minimum:g} m",
            others=tuple(edit.sequence),
            minimum=edit.minimum,
        )
    if isinstance(edit, Move) and any(edit.aside):
        x, y, z = edit.aside
        return message(
            "project.moved-aside",
            "control point ({i}, {j}) of patch {patch} moved by {dz:+.3f} m and sideways by ({x:+.3f}, {y:+.3f}, "
            "{z:+.3f}) m",
            i=edit.i,
            j=edit.j,
            patch=edit.patch,
            dz=edit.dz,
            x=x,
            y=y,
            z=z,
        )
    if isinstance(edit, Move):
        return message(
            "project.moved",
            "control point ({i}, {j}) of patch {patch} moved by {dz:+.3f} m",
            i=edit.i,
            j=edit.j,
            patch=edit.patch,
            dz=edit.dz,
        )
    if isinstance(edit, MoveToPointEdit):
        return message(
            "project.moved-towards-point",
            "pulled towards point {number} by {share:.0f} % of its residual",
            number=edit.index + 1,
            share=100 * edit.share,
        )
    return message(
        "project.weighed",
        "control point ({i}, {j}) of patch {patch} given the weight {weight:g}",
        i=edit.i,
        j=edit.j,
        patch=edit.patch,
        weight=edit.weight,
    )
