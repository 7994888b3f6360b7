"""Cells of tables: typeset where they are shown, plain where they are copied and exported."""

from __future__ import annotations

import csv

import numpy as np
from PySide6.QtWidgets import QApplication

from geofit.gui.panels.tables import DataTable, TableColumn

GAP = "\N{NO-BREAK SPACE}"


def test_cells_are_typeset_and_files_are_plain(qtbot, tmp_path):
    table = DataTable()
    qtbot.addWidget(table)
    table.show_columns(
        [
            TableColumn("Part", np.array(["T3-T2", "whole", "rest"])),
            TableColumn("Volume, m³", np.array([437192.4, 9999.0, np.nan]), 0),
            TableColumn("Change", np.array([-0.001, -12.5, -43210.06]), 1),
            TableColumn("Easting, m", np.array([500000.0, -12345.0, 0.0]), 1, coordinate=True),
            TableColumn("Row", np.array([1, 12345, 3])),
        ]
    )
    shown = [[table.rows.data(table.rows.index(r, k)) for k in range(5)] for r in range(3)]
    assert shown == [
        ["T3-T2", f"437{GAP}192", "0.0", "500000.0", "1"],
        ["whole", "9999", "−12.5", "−12345.0", "12345"],
        ["rest", "", f"−43{GAP}210.1", "0.0", "3"],
    ]
    table.copy()
    table.export(tmp_path / "rows.csv")
    plain = [
        ["T3-T2", "437192", "0.0", "500000.0", "1"],
        ["whole", "9999", "-12.5", "-12345.0", "12345"],
        ["rest", "", "-43210.1", "0.0", "3"],
    ]
    assert [line.split("\t") for line in QApplication.clipboard().text().splitlines()[1:]] == plain
    with (tmp_path / "rows.csv").open(encoding="utf-8-sig", newline="") as file:
        assert list(csv.reader(file))[1:] == plain
