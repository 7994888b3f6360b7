"""A fictional dam site whose truth is known; ``python -m geofit.sample OUT`` writes its files."""

from geofit.sample.bodies import body_truth
from geofit.sample.site import write_site
from geofit.sample.truth import horizon_truth

__all__ = ["body_truth", "horizon_truth", "write_site"]
