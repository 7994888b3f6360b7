"""How many cases a test takes: as many as are quick in the suite, all that the method asks for its page of figures.

``benchmarks/pore_tests.py`` sets GEOFIT_ALL_CASES and so runs every test at its full count.
"""

from __future__ import annotations

import os

ALL_CASES = bool(os.environ.get("GEOFIT_ALL_CASES"))


def cases(asked: int, quick: int) -> int:
    """Return the count that the method asks for where all cases are wanted, else the quick one."""
    return asked if ALL_CASES else quick
