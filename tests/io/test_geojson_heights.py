"""GeoJSON with elevations: GDAL names another system for it than for places in plan."""

from __future__ import annotations

import json

import pytest

from geofit.data.errors import InputError
from geofit.io import read_points

pytest.importorskip("pyogrio")


@pytest.mark.parametrize("deep", [False, True])
@pytest.mark.parametrize("degrees", [False, True])
def test_places_in_metres_are_read_and_degrees_refused(degrees, deep, tmp_path):
    """Metres with elevations were refused as longitude and latitude (EPSG:4979)."""
    origin = (110.1, 30.2) if degrees else (500_000.0, 3_100_000.0)
    step = 1e-4 if degrees else 10.0
    features = []
    for i in range(30):
        place = [origin[0] + step * (7 * i % 11), origin[1] + step * (5 * i % 13)]
        geometry = {"type": "Point", "coordinates": [*place, 5.0 + i] if deep else place}
        properties = {} if deep else {"elevation": 5.0 + i}
        features.append({"type": "Feature", "geometry": geometry, "properties": properties})
    (tmp_path / "a.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": features}), "utf-8")
    if degrees:
        with pytest.raises(InputError, match="longitude and latitude"):
            read_points(tmp_path / "a.geojson")
        return
    points = read_points(tmp_path / "a.geojson").horizons["a"]
    assert points.xyz[:, 0].tolist() == [origin[0] + step * (7 * i % 11) for i in range(30)]
    assert points.xyz[:, 2].tolist() == [5.0 + i for i in range(30)]
