"""What is called exact is exact: points of a core that its surface misses count as approximated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geofit.checks.check import CORE_LIMIT
from geofit.data.messages import message
from geofit.fitting.horizon_fit import HorizonFit, fit_of
from geofit.fitting.split import Split

__all__ = ["exact_or_not"]

#: Code of the note about a core's point that was let go.
TORN = "fitting.core-points-contradict"


def exact_or_not(surface: HorizonFit) -> HorizonFit:
    """Call those points exact that the surface meets.

    It may miss some between the sections of a fold, and one of two that contradict each other.
    """
    model, accuracy = surface.model, surface.accuracy
    assert model is not None
    assert accuracy is not None
    missed = surface.core & (np.abs(accuracy.residuals) > CORE_LIMIT)
    torn = sum(note.code == TORN for note in accuracy.notes)
    if not missed.any() or not (model.problem.parametrization.parametric or missed.sum() <= torn):
        return surface
    split = model.problem.split
    reason = message(
        "fitting.points-called-approximated",
        "{reason}; points that it misses, by up to {worst:.3g} m, and that count as approximated: {count}",
        reason=split.reason,
        count=int(missed.sum()),
        worst=float(np.abs(accuracy.residuals[missed]).max()),
    )
    known = replace(model.problem, split=Split(split.core, split.inside & ~missed, reason))
    found = fit_of(replace(model, problem=known))
    assert found.accuracy is not None
    noted_before = tuple(note for note in accuracy.notes if note not in found.accuracy.notes)
    return found.with_(accuracy=replace(found.accuracy, notes=(*found.accuracy.notes, *noted_before)))
