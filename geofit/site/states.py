"""Two states of a horizon compared: what moved, and whether the earlier band held at what was found since."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from geofit.data.messages import Message
from geofit.data.points import PointSet
from geofit.data.prediction import PredictionResult
from geofit.data.progress import Progress, tell
from geofit.fitting.horizon_fit import HorizonFit
from geofit.site.change import HorizonChange, horizon_change
from geofit.site.new_contacts import BlindTest, blind_test

__all__ = ["Comparison", "compare_fits", "compared"]


@dataclass(frozen=True, eq=False)
class Comparison:
    """How a horizon moved between two states, and the test of the earlier band at the new contacts.

    ``before`` and ``after`` are the sigmas at the data, metres; ``notes`` say what could not be found.
    """

    change: HorizonChange
    test: BlindTest
    before: float
    after: float
    notes: tuple[Message, ...] = ()

    @property
    def name(self) -> str:
        """Name of the horizon."""
        return self.change.name


def compare_fits(
    before: HorizonFit,
    after: HorizonFit,
    known: PointSet | None = None,
    found: PointSet | None = None,
    prediction: PredictionResult | None = None,
    progress: Progress | None = None,
) -> Comparison:
    """Compare two fits of a horizon.

    Parameters
    ----------
    before, after : HorizonFit
        Of the earlier and of the later data; ``before`` as fitted, so that its band is known.
    known : PointSet, optional
        All points of the earlier data; None: those of ``before``.
    found : PointSet, optional
        All points of the later data, those too that its fit left out; None: those of ``after``.
    prediction : PredictionResult, optional
        ``examine(before)``; None: it is examined here.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Returns
    -------
    Comparison
    """
    from geofit.prediction.examine import examine

    if prediction is None:
        prediction = examine(before, progress)
    tell(progress, "difference", 0.8)
    change = horizon_change(before, after)
    known, found = before.points if known is None else known, after.points if found is None else found
    test = blind_test(before, prediction.uncertainty, known, found)
    notes = () if prediction.uncertainty is not None else prediction.notes
    first, second = (one.accuracy.sigma if one.accuracy is not None else float("nan") for one in (before, after))
    return Comparison(change, test, first, second, notes)


def compared(
    earlier: Mapping[str, HorizonFit], later: Mapping[str, HorizonFit], progress: Progress | None = None
) -> dict[str, Comparison]:
    """Compare the horizons that two states of a site have in common."""
    return {
        name: compare_fits(before, later[name], progress=progress) for name, before in earlier.items() if name in later
    }
