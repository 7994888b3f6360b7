"""Centre lines as tables: sections by radius, width and height, or four walls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from geofit.caves.adjust import adjust_survey
from geofit.caves.body import centreline_body
from geofit.data.errors import InputError
from geofit.io.centreline import read_centreline
from geofit.io.source import Source


@pytest.fixture
def table(tmp_path):
    def read(text, **options):
        path = tmp_path / "line.csv"
        path.write_text(text, encoding="utf-8")
        level = options.pop("level", "axis")
        return read_centreline(Source(path=path, **options), level=level)

    return read


def test_a_tunnel_has_the_volume_of_its_section(table):
    found = table("station,x,y,z,width,height\na,500000,4000000,100,4,3\nb,500060,4000080,100,4,3\n")
    assert found.across
    assert dict(found.fixed)["b"] == (500060.0, 4000080.0, 100.0)
    body = centreline_body(found, ends="flat")
    assert body.length == pytest.approx(100)
    assert body.volume(0.2) == pytest.approx(np.pi / 4 * 4 * 3 * 100, rel=0.004)


def test_a_radius_is_across_a_sloping_line(table):
    body = centreline_body(table("x,y,z,radius\n0,0,0,2\n30,0,-30,2\n"), ends="flat")
    assert body.sweeps.volumes.sum() == pytest.approx(np.pi * 4 * 30 * np.sqrt(2))


def test_a_line_along_the_floor(table):
    found = table("x,y,z,width,height\n0,0,0,4,3\n9,0,0,4,3\n", level="floor")
    np.testing.assert_allclose(found.walls, [[2, 2, 3, 0]] * 2)


@pytest.mark.parametrize("finer", [1.0, 1.1, 1.23])
@pytest.mark.parametrize(("width", "height"), [(6, 4), (3, 3), (5, 5)])
def test_a_tunnel_surveyed_at_its_floor_has_its_volume(table, width, height, finer):
    found = table(f"x,y,z,width,height\n0,0,300,{width},{height}\n100,0,300,{width},{height}\n", level="floor")
    body = centreline_body(found, ends="flat")
    assert body.volume(body.fine * finer) == pytest.approx(body.sweeps.volumes.sum(), rel=0.005)


def test_the_size_of_a_long_thin_tunnel_is_as_exact_as_it_says(table):
    body = centreline_body(table("x,y,z,width,height\n0,0,0,1.2,0.8\n100,0,0,1.2,0.8\n"), ends="flat")
    truth = np.pi / 4 * 1.2 * 0.8 * 100
    assert body.size.volume == pytest.approx(truth, rel=0.002)
    assert body.size.volume_error <= 0.002 * truth


def test_lines_meet_at_stations_of_one_name_and_place(table):
    found = table(
        "adit,station,x,y,z,left,right,up,down\nA,1,0,0,0,1,2,3,4\nA,2,10,0,0,1,,3,4\nB,2,10,0,0,,,,\nB,3,10,9,0,1,1,1,1\n"
        "C,1,50,0,0,1,1,1,1\nC,2,60,0,0,1,1,1,1\n"
    )
    # Line C numbers its stations anew: they are other places.
    assert found.stations == ("1", "2", "3", "C.1", "C.2")
    assert list(zip(found.start.tolist(), found.end.tolist(), strict=True)) == [(0, 1), (1, 2), (3, 4)]
    assert np.isnan(found.walls[1]).tolist() == [False, True, False, False]
    assert found.counts[0].used == 6


def test_feet_in_headers_are_converted(table):
    found = table("x_ft,y_ft,z_ft,radius_ft\n0,0,0,10\n100,0,0,10\n")
    np.testing.assert_allclose(found.offset, [[30.48, 0, 0]])
    np.testing.assert_allclose(found.walls, 3.048)


def test_a_negative_size_is_missing_and_a_repeated_station_is_listed(table):
    found = table("station,x,y,z,radius\na,0,0,0,2\na,0,0,0,2\nb,5,0,0,-1\nc,9,0,0,x\nd,12,0,0,2\n")
    assert found.stations == ("a", "b", "d")
    assert np.isnan(found.walls[found.stations.index("b")]).all()
    reasons = {issue.reason.code: issue.reason for issue in found.issues if issue.severity != "note"}
    assert reasons["io.station-repeated"].params["row"] == 2
    assert "io.size-taken-as-missing" in reasons
    assert found.counts[0].read == 5
    assert found.counts[0].listed == 2


@pytest.mark.parametrize(("row", "code"), [("1e9,0,0,1", "caves.shot-too-long"), ("9,0,0,1e300", "io.size-too-large")])
def test_a_blunder_of_size_is_listed_and_leaves_no_station(table, row, code):
    found = table(f"x,y,z,radius\n0,0,0,1\n{row}\n20,0,0,1\n")
    assert found.stations == ("row 2", "row 4")
    (issue,) = [issue for issue in found.issues if issue.severity == "error"]
    assert (issue.row, issue.reason.code) == (3, code)
    assert found.counts[0].listed == 1


def test_coordinates_alone_make_no_loop(table):
    """A shot between two fixed stations checks them only where it was measured."""
    survey = table("x,y,z,radius\n500000,0,0,1\n500010.1,0,0,1\n500020,0.3,0,1\n500030,5,0,1\n")
    assert not adjust_survey(survey).loops
    measured = replace(survey, offset=survey.offset + np.array([0.1, 0.0, 0.0]))
    assert [round(loop.distance, 6) for loop in adjust_survey(measured).loops] == [0.1] * 3


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("x,y,z\n0,0,0\n1,0,0\n", "does not give the size of the section"),
        ("x,y,z,radius\n0,0,0,1\n", "two usable stations"),
    ],
)
def test_tables_that_are_no_centre_line(table, text, match):
    with pytest.raises(InputError, match=match):
        table(text)
