"""Which horizon a row belongs to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.labels import Labels
from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.io.rows import Rows

__all__ = ["HorizonNames"]


class HorizonNames:
    """The horizons of a site; without any, every name that occurs in the data makes one.

    Case and outer blanks do not matter; the first spelling that is met names the horizon.
    """

    def __init__(self, names: Sequence[str] = ()) -> None:
        self.names = tuple(names)
        self._known = {name.casefold(): name for name in names}

    def match(self, text: str) -> str | None:
        """Return the horizon that a cell or layer names; None if the site has no such horizon."""
        return self._known.get(text.casefold()) if self.names else self._known.setdefault(text.casefold(), text)

    def of(self, rows: Rows, role: str = "horizon") -> list[str]:
        """Return the horizon of each row; rows without one, or with an unknown one, are rejected."""
        named = self.labels(rows, role)
        return [named.table[code] for code in named.codes.tolist()]

    def labels(self, rows: Rows, role: str = "horizon") -> Labels:
        """Return the horizon of each row, as :meth:`of`, as codes."""
        cells = rows.labels(role)
        named = cells.renamed([self.match(cell) or cell for cell in cells.table])
        if not self.names and (merged := sorted(set(cells.table) - set(named.table))):
            rows.journal.add(
                "note",
                rows.file,
                message(
                    "io.horizon-names-merged",
                    "Names that differ in case only are one horizon: {names}",
                    names=", ".join(f"{name} = {self.match(name)}" for name in merged),
                ),
                message("io.rename-other-horizon", "If they are two, rename one."),
                column=rows.table.header[rows.columns[role]],
            )
        if self.names and not set(self.names).issuperset(named.table):
            texts = [named.table[code] for code in named.codes.tolist()]
            named = Labels.of(rows.require_known(role, texts, self.names, "site file's [[horizon]] list"))
        return named

    @staticmethod
    def split(
        rows: Rows, horizon: Sequence[str] | Labels, xyz: NDArray[np.float64], **columns: Any
    ) -> dict[str, PointSet]:
        """Return the used rows as one set of points a horizon, in file order."""
        everything = bool(rows.ok.all())
        names = horizon if isinstance(horizon, Labels) else Labels.of(horizon)
        given: Mapping[str, Any] = {
            key: value if isinstance(value, (str, float, Labels)) else np.asarray(value)
            for key, value in columns.items()
        }
        used = names.codes if everything else names.codes[rows.ok]
        first = np.full(len(names.table), len(used), np.int64)
        first[used[::-1]] = np.arange(len(used))[::-1]  # the last one written is the first of its kind
        result = {}
        for code in np.argsort(first, kind="stable")[: int((first < len(used)).sum())].tolist():
            alone = everything and int((first < len(used)).sum()) == 1

            def chosen(values: Any, code: int = code, alone: bool = alone) -> Any:
                if alone or isinstance(values, (str, float)):
                    return values
                return values[rows.ok & (names.codes == code)]

            own = {key: chosen(value) for key, value in {"xyz": xyz, "row": rows.line, **given}.items()}
            for value in own.values():
                if isinstance(value, np.ndarray):
                    value.setflags(write=False)
            result[names.table[code]] = PointSet(**own, file=rows.file)
        return result
