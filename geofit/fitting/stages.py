"""The stages of a fit: told to who listens, and timed."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

from geofit.data.progress import Progress, tell

__all__ = ["Stages"]


@dataclass
class Stages:
    """Seconds that each stage took, by its name; a call begins the next."""

    progress: Progress | None
    seconds: dict[str, float] = field(default_factory=dict)
    _stage: str = ""
    _since: float = 0.0

    def __call__(self, name: str, fraction: float) -> None:
        """Tell that a stage begins, at a fraction (0 to 1) of the whole fit."""
        now = time.perf_counter()
        if self._stage:
            self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + now - self._since
        self._stage, self._since = name, now
        tell(self.progress, name, fraction)
