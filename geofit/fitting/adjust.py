"""Local adjustment where sigma is not yet below epsilon (paper, sec. 3.3): nothing outside a support moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message
from geofit.fitting.density import CLOUD
from geofit.fitting.horizon_fit import HorizonFit, fit_of
from geofit.fitting.model import Model
from geofit.fitting.net import Net
from geofit.fitting.parametrize import Parametrization
from geofit.fitting.skin import regularized_correction

__all__ = ["adjust_locally", "pull_to_worst"]

Floats = NDArray[np.float64]

#: Share of the squared residuals that one step takes away.
SHARE = 0.7


def adjust_locally(model: Model, surface: HorizonFit) -> HorizonFit:
    """Adjust locally until sigma is below epsilon or no step helps, and say which.

    Points that are known less accurately than the tolerance are not chased, nor those of a cloud, of data that
    contradict each other, or that contradict a neighbour.
    """
    given, left = model.problem, _left_as_they_are(model)
    for step in range(given.settings.max_iterations + 1):
        accuracy = surface.accuracy
        assert accuracy is not None
        if accuracy.sigma < accuracy.epsilon:
            if step:
                surface = _with_note(
                    surface,
                    message(
                        "fitting.sigma-brought-below-epsilon",
                        "local adjustments until sigma came below epsilon: {step}",
                        step=step,
                    ),
                )
            break
        if left is not None:
            surface = _with_note(surface, left.with_severity("warning"))
            break
        better = pull_to_worst(model.net, given.parametrization, _movable(model, surface), accuracy.residuals)
        tried = None if better is None or step == given.settings.max_iterations else model.with_net(better)
        candidate = None if tried is None else fit_of(tried)
        if candidate is None or candidate.accuracy is None or candidate.accuracy.sigma > 0.99 * accuracy.sigma:
            words = message(
                "fitting.sigma-above-epsilon",
                "sigma stays above epsilon: no further local adjustment lowers it (made: {step})",
                step=step,
            )
            surface = _with_note(surface, words.with_severity("warning"))
            break
        assert tried is not None
        model, surface = tried, candidate
    return _without_unmet(model, surface)


def _movable(model: Model, surface: HorizonFit) -> NDArray[np.bool_]:
    """Return (n,) which points the surface may be moved to."""
    given = model.problem
    movable = given.kept & ~surface.core
    movable[given.kept] &= ~model.net.torn
    if not given.settings.strict:
        movable &= ~(given.accuracy > given.settings.interior_tolerance)
    return movable


def _without_unmet(model: Model, surface: HorizonFit) -> HorizonFit:
    """Take back the note that points stay beyond the tolerance, where all that may be met are within it by now."""
    accuracy = surface.accuracy
    assert accuracy is not None
    others = tuple(note for note in accuracy.notes if note.code != "fitting.tolerance-not-met")
    if others == accuracy.notes or (np.abs(accuracy.residuals[_movable(model, surface)]) > model.net.limit).any():
        return surface
    return surface.with_(accuracy=replace(accuracy, notes=others))


def _left_as_they_are(model: Model) -> Message | None:
    """Return why points beyond the tolerance stay where they are, or None."""
    settings = model.problem.settings
    if settings.strict:
        return None
    if len(model.problem.points) > CLOUD:
        return message(
            "fitting.sigma-of-cloud",
            "sigma stays above epsilon: the points of a cloud are not met one by one",
        )
    # A smoothing that was given may be stiffer than the data ask for.
    if settings.smoothing == "auto" and model.net.field.contradictory:
        return message(
            "fitting.sigma-of-contradiction",
            "sigma stays above epsilon: data that contradict each other are not met one by one",
        )
    return None


def pull_to_worst(
    net: Net, parametrization: Parametrization, movable: NDArray[np.bool_], residuals: Floats
) -> Net | None:
    """Pull the surface to the points that contribute most to sigma.

    Parameters
    ----------
    net : Net
        The surface.
    parametrization : Parametrization
        Places and values of all points.
    movable : (n,) array of bool
        Points that the surface may be moved to: active, and not in the core.
    residuals : (n,) array
        Distances of all points, metres.

    Returns
    -------
    Net or None
        The adjusted surface; the core's control points stay. None if no point can be met.
    """
    candidates = np.flatnonzero(movable)
    squares = residuals[candidates] ** 2
    order = np.argsort(-squares, kind="stable")
    enough = int(np.searchsorted(np.cumsum(squares[order]), SHARE * squares.sum())) + 1
    worst = candidates[order[:enough]]
    if not squares.any():
        return None
    matrix = net.space.matrix(parametrization.plane[worst] / net.unit)
    misfit = parametrization.values[worst] - matrix @ net.coefficients
    change = regularized_correction(matrix, misfit, ~net.frozen)
    return replace(net, coefficients=net.coefficients + change)


def _with_note(surface: HorizonFit, note: Message) -> HorizonFit:
    assert surface.accuracy is not None
    return surface.with_(accuracy=replace(surface.accuracy, notes=(*surface.accuracy.notes, note)))
