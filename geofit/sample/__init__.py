"""A fictional dam site whose truth is known; ``python -m geofit.sample OUT`` writes its files."""

from geofit.sample.site import write_site
from geofit.sample.truth import horizon_truth

__all__ = ["horizon_truth", "write_site"]
