"""Which horizon a row belongs to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.points import PointSet
from geofit.io.rows import Rows

__all__ = ["HorizonNames"]


class HorizonNames:
    """The horizons of a site; without any, every name that occurs in the data makes one.

    Case and outer blanks do not matter.
    """

    def __init__(self, names: Sequence[str] = ()) -> None:
        self.names = tuple(names)
        self._known = {name.casefold(): name for name in names}

    def match(self, text: str) -> str | None:
        """Return the horizon that a cell or layer names; None if the site has no such horizon."""
        return self._known.get(text.casefold()) if self._known else text

    def of(self, rows: Rows, role: str = "horizon") -> list[str]:
        """Return the horizon of each row; rows without one, or with an unknown one, are rejected."""
        cells = rows.text(role)
        matched = {cell: self.match(cell) for cell in set(cells)}
        named = [matched[cell] or cell for cell in cells]
        if self._known:
            rows.require_known(role, named, self.names, "site file's [[horizon]] list")
        return named

    @staticmethod
    def split(rows: Rows, horizon: Sequence[str], xyz: NDArray[np.float64], **columns: Any) -> dict[str, PointSet]:
        """Return the used rows as one set of points a horizon, in file order."""
        used = np.flatnonzero(rows.ok)
        names = np.array(horizon, dtype=np.str_)
        arrays: Mapping[str, Any] = {
            key: value if isinstance(value, str) else np.asarray(value) for key, value in columns.items()
        }
        result = {}
        for name in dict.fromkeys(names[used].tolist()):
            chosen = used[names[used] == name]
            result[name] = PointSet(
                xyz[chosen],
                row=rows.line[chosen],
                file=rows.file,
                **{key: value if isinstance(value, str) else value[chosen] for key, value in arrays.items()},
            )
        return result
