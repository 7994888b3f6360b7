"""Previews of bodies: fewer data, nearly the same body, stopped between stages."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bodies.planted import drilled, ellipsoid

from geofit.bodies.fit import fit_body
from geofit.bodies.outlines import from_outlines
from geofit.bodies.settings import BodySettings
from geofit.data.errors import Cancelled
from geofit.io.outlines import read_outlines
from geofit.project.body_preview import preview_body, thinned_data
from geofit.project.body_record import Outlines

ANGLE = np.linspace(0, 2 * np.pi, 60, endpoint=False)


@pytest.fixture
def outlines(tmp_path: Path) -> Path:
    import ezdxf

    document = ezdxf.new("R2010")
    for x in np.linspace(-55, 55, 21):
        size = np.sqrt(1 - (x / 60) ** 2)
        ring = np.column_stack([np.full(60, x), 40 * size * np.cos(ANGLE), 30 * size * np.sin(ANGLE)])
        ring += np.array([1000.0, 2000.0, 500.0])
        document.modelspace().add_polyline3d(ring, close=True, dxfattribs={"layer": "ORE"})
    document.saveas(tmp_path / "ore.dxf")
    return tmp_path


def test_a_preview_is_nearly_the_body(outlines: Path) -> None:
    found = preview_body(Outlines("ore.dxf"), BodySettings(), (), outlines)
    body = fit_body(from_outlines(read_outlines(outlines / "ore.dxf").outlines))
    assert found.contacts == 300 < found.of == len(body.contacts)
    assert found.mesh.is_closed
    assert found.mesh.volume == pytest.approx(body.overview.volume, rel=0.03)
    assert np.abs(body.distance(found.mesh.vertices)).max() < 3.0


def test_a_preview_stops_between_its_stages(outlines: Path) -> None:
    seen: list[object] = []

    def listen(stage: object, fraction: float) -> bool:
        seen.append(stage)
        return fraction < 0.3

    with pytest.raises(Cancelled):
        preview_body(Outlines("ore.dxf"), BodySettings(), (), outlines, progress=listen)
    assert seen[-1] == "fit"


def test_thinned_data_keep_their_names_and_lengths() -> None:
    data = drilled(ellipsoid((0.6, 0.4, 0.3))[0], 3, rows=9)
    few = thinned_data(data, 20, 100)
    assert len(few.contacts) == 20
    assert max(len(few.inside), len(few.outside)) <= 100
    rows = {tuple(xyz): name for xyz, name in zip(data.contacts.tolist(), data.hole.tolist(), strict=True)}
    assert [rows[tuple(xyz)] for xyz in few.contacts.tolist()] == few.hole.tolist()
    assert thinned_data(few, 20, 100) is few
