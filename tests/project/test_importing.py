"""geofit import: files of one site, in any order, to a site file that reads."""

from __future__ import annotations

import csv

import ezdxf
import numpy as np
import pytest

from geofit.data.errors import Cancelled, InputError
from geofit.io import read_site
from geofit.io.mapping import ColumnMapping, load_mappings
from geofit.project.importing import import_files

COLLAR = "BHID,XCOLLAR,YCOLLAR,ZCOLLAR\n" + "".join(
    f"B{i},{500000 + 40 * i},{3100000 + 9 * i},{100 + i}\n" for i in range(5)
)
LOG = "hole,from,to,rock\n" + "".join(f"B{i},0,{10 + i},clay\nB{i},{10 + i},50,granite\n" for i in range(5))
FILES = {
    "collar.csv": COLLAR,
    "log.csv": LOG,
    "survey.csv": "BHID,AT,AZ,DIP\nB1,0,90,60\nB1,20,90,61\nB9,0,90,60\n",
    "outline.csv": "x;y\n499900;3099900\n501000;3099900\n501000;3101000\n499900;3101000\n",
    "ground.asc": "ncols 2\nnrows 2\nxllcorner 499000\nyllcorner 3099000\ncellsize 2000\n120 120\n120 120\n",
    "lines.csv": "section,x,y\nC1,500000,3100000\nC1,500300,3100400\n",
    "C1.csv": "horizon,distance,elevation\nbase of clay,100,85\nfault,200,60\nfault,2000,60\n",
    "C7.csv": "horizon,distance,elevation\nfault,100,85\n",
    "outcrops.csv": "horizon,x,y\nfault,500100,3100100\n",
    "dips.csv": "X,Y,Z,azimuth,dip,formation\n500100,3100100,80,90,30,fault\n",
    "junk.csv": "a,b\nu,v\nw,x\n",
    "no rows.csv": "hole,x,y,z\n",
}


@pytest.fixture
def folder(tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def counts_of(found):
    assert all(count.read == count.used + count.listed for count in found.counts)
    return {count.file: (count.used, count.listed) for count in found.counts}


@pytest.mark.parametrize("order", [1, -1])
def test_a_whole_site(folder, order):
    found = import_files([folder / name for name in list(FILES)[::order]], folder / "site.toml")
    assert counts_of(found) == {
        "collar.csv": (5, 0),
        "survey.csv": (2, 1),
        "log.csv": (10, 0),
        "outline.csv": (4, 0),
        "ground.asc": (2, 0),
        "lines.csv": (2, 0),
        "C1.csv": (2, 1),
        "C7.csv": (0, 1),
        "outcrops.csv": (1, 0),
        "dips.csv": (1, 0),
        "junk.csv": (0, 2),
        "no rows.csv": (0, 0),
    }
    assert found.exit_code == 0
    again = read_site(folder / "site.toml")
    assert list(again.horizons) == ["base of clay", "fault"]
    for name, points in found.site.horizons.items():
        np.testing.assert_array_equal(again.horizons[name].xyz, points.xyz)
    # Five contacts and one point of the section; the hole B1 is inclined.
    assert len(again.horizons["base of clay"]) == 6
    np.testing.assert_allclose(again.horizons["base of clay"].xyz[0], [500000, 3100000, 90])
    assert len(again.orientations) == 1
    with (folder / "site_issues.csv").open(encoding="utf-8-sig", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert any(row["file"] == "C7.csv" and "no line in plan" in row["reason"] for row in rows)
    assert any("'ZCOLLAR' is taken as z" in row["reason"] for row in rows)
    mappings = {mapping.file: mapping for mapping in load_mappings(folder / "site_mapping.toml")}
    assert mappings["log.csv"].columns == {"hole": "hole", "from": "from", "to": "to", "code": "rock"}


def test_asked_limits_and_a_mapping(folder):
    mapping = ColumnMapping(file="log.csv", kind="intervals", columns={"code": "rock"}, unit="ft")
    files = [folder / "collar.csv", folder / "log.csv"]
    found = import_files(files, folder / "deep" / "s.toml", mappings=[mapping], top=["granite"])
    assert list(found.site.horizons) == ["top of granite"]
    np.testing.assert_allclose(found.site.horizons["top of granite"].xyz[0, 2], 100 - 10 * 0.3048)
    assert counts_of(found) == {"../collar.csv": (5, 0), "../log.csv": (10, 0)}


def test_a_table_that_is_left_out(folder):
    skip = ColumnMapping(file="junk.csv", kind="skip")
    found = import_files([folder / "collar.csv", folder / "junk.csv"], folder / "s.toml", mappings=[skip])
    assert found.exit_code == 1
    assert not [issue for issue in found.issues if issue.severity == "error"]


def test_two_campaigns_share_their_codes(folder):
    (folder / "c2.csv").write_text(COLLAR.replace("B", "K").replace("KHID", "BHID"), encoding="utf-8")
    (folder / "l2.csv").write_text(LOG.replace("B", "K"), encoding="utf-8")
    names = ["l2.csv", "collar.csv", "log.csv", "c2.csv"]
    found = import_files([folder / name for name in names], folder / "s.toml")
    points = found.site.horizons["base of clay"]
    assert sorted(points.hole.tolist()) == sorted(f"{letter}{i}" for letter in "BK" for i in range(5))
    assert len(found.site.holes) == 10


def test_nothing_usable(folder):
    found = import_files([folder / "junk.csv", folder / "absent.csv"], folder / "s.toml")
    assert found.exit_code == 2
    with pytest.raises(InputError, match="No file"):
        import_files([], folder / "s.toml")


def test_logs_without_their_collars_are_listed(folder):
    (folder / "collar.csv").write_text(COLLAR.replace("10", "x"), encoding="utf-8")
    found = import_files([folder / "collar.csv", folder / "log.csv"], folder / "s.toml")
    assert counts_of(found) == {"collar.csv": (0, 5), "log.csv": (0, 10)}


def test_import_can_be_stopped(folder):
    with pytest.raises(Cancelled):
        import_files([folder / "collar.csv"], folder / "s.toml", progress=lambda stage, share: share < 0.5)
    assert not [path for path in folder.iterdir() if ".part" in path.name]


def test_the_command(folder):
    from typer.testing import CliRunner

    from geofit.cli.main import app

    names = [str(folder / name) for name in ("collar.csv", "log.csv", "junk.csv")]
    run = CliRunner().invoke(app, ["import", *names, "--site", str(folder / "s.toml"), "--base", "clay"])
    assert run.exit_code == 0, run.output
    assert "base of clay" in run.output
    assert read_site(folder / "s.toml").horizons["base of clay"].hole.tolist() == ["B0", "B1", "B2", "B3", "B4"]
    run = CliRunner().invoke(app, ["import", names[2], "--site", str(folder / "t.toml")])
    assert run.exit_code == 2


def test_a_unit_holds_for_every_file_whose_mapping_states_none(folder):
    """Metres, read as feet: every length is 0.3048 of before, tables, drawing and grid alike, when read again too."""
    drawing = ezdxf.new()
    drawing.modelspace().add_line((10, 80), (40, 82), dxfattribs={"layer": "fault"})
    drawing.saveas(folder / "C1.dxf")
    files = [folder / name for name in ("collar.csv", "log.csv", "lines.csv", "C1.dxf", "ground.asc", "outline.csv")]
    metres = import_files(files, folder / "m.toml").site
    import_files(files, folder / "f.toml", unit="feet")
    feet = read_site(folder / "f.toml")
    assert set(feet.horizons) == set(metres.horizons) == {"base of clay", "fault"}
    for name, points in metres.horizons.items():
        np.testing.assert_allclose(feet.horizons[name].xyz, 0.3048 * points.xyz)
    np.testing.assert_allclose(feet.ground.z, 0.3048 * metres.ground.z)
    np.testing.assert_allclose(feet.boundary, 0.3048 * metres.boundary)
    stated = ColumnMapping(file="log.csv", kind="intervals", columns={"code": "rock"}, unit="m")
    one = import_files(files[:2], folder / "o.toml", mappings=[stated], unit="ft").site
    np.testing.assert_allclose(one.horizons["base of clay"].xyz[0, 2], 100 * 0.3048 - 10)
    with pytest.raises(InputError, match="The unit 'yard' is unknown"):
        import_files(files, folder / "y.toml", unit="yard")


def test_an_import_that_fails_lists_what_it_found(folder):
    """No site file, but the table of issues that an import writes, and the code that was asked for as the reason."""
    from typer.testing import CliRunner

    from geofit.cli.main import app

    names = [str(folder / name) for name in ("collar.csv", "survey.csv", "log.csv", "junk.csv")]
    run = CliRunner().invoke(app, ["import", *names, "--site", str(folder / "s.toml"), "--base", "klay"])
    assert run.exit_code == 2
    assert "s_issues.csv" in run.output
    assert "geofit: log.csv: No interval has the code 'klay'" in run.output
    assert not (folder / "s.toml").exists()
    with (folder / "s_issues.csv").open(encoding="utf-8-sig", newline="") as stream:
        assert {row["file"] for row in csv.DictReader(stream)} >= {"survey.csv", "junk.csv"}


def test_a_drawing_is_placed_by_its_line(folder):
    drawing = ezdxf.new()
    drawing.modelspace().add_line((10, 80), (40, 82), dxfattribs={"layer": "fault"})
    drawing.modelspace().add_line((500, 80), (40, 82), dxfattribs={"layer": "base of clay"})
    drawing.saveas(folder / "c1.dxf")
    (folder / "C7.dxf").write_bytes((folder / "c1.dxf").read_bytes())
    (folder / "lines.csv").write_text(FILES["lines.csv"] + "C7,500000,3100000\n", encoding="utf-8")
    names = ("collar.csv", "log.csv", "lines.csv", "c1.dxf", "C7.dxf")
    found = import_files([folder / name for name in names], folder / "s.toml")
    assert list(found.site.horizons) == ["base of clay", "fault"]
    np.testing.assert_allclose(found.site.horizons["fault"].xyz, [[500006, 3100008, 80], [500024, 3100032, 82]])
    assert counts_of(found)["c1.dxf"] == (4, 0)
    assert any(issue.file == "C7.dxf" and "no line in plan" in str(issue.reason) for issue in found.issues)
    found = import_files([folder / name for name in (*names, "C1.csv")], folder / "s.toml")
    assert any(issue.file == "c1.dxf" and "from C1.csv already" in str(issue.reason) for issue in found.issues)


def test_one_table_of_two_kinds_and_degrees(folder):
    pyproj = pytest.importorskip("pyproj")
    limits = ((0, "Q"), (20, "T"))
    rows = [f"W{i},{117 + i / 1000},28.2,{100 + i},{z},{z + 20},{code}" for i in range(4) for z, code in limits]
    (folder / "wells.csv").write_text("well,lon,lat,elevation,top,base,formation\n" + "\n".join(rows), encoding="utf-8")
    kinds = [ColumnMapping(file="wells.csv", kind=kind) for kind in ("collar", "intervals")]
    found = import_files([folder / "wells.csv"], folder / "s.toml", mappings=kinds, crs="EPSG:32650")
    east, north = pyproj.Transformer.from_crs(4326, 32650, always_xy=True).transform(117.0, 28.2)
    np.testing.assert_allclose(found.site.horizons["base of Q"].xyz[0], [east, north, 80], atol=1e-6)
    assert [(c.used, c.listed) for c in found.counts] == [(4, 4), (8, 0)]


def test_bases_are_named_and_issues_told_in_the_language_asked_for(folder):
    from chinese import english_left

    from geofit.data.languages import ZH

    found = import_files([folder / name for name in ("collar.csv", "log.csv")], folder / "s.toml", language=ZH)
    assert [name for name in found.site.horizons if name.endswith("底界")] == list(found.site.horizons)
    told = found.issue_file.read_text("utf-8-sig")
    assert not [left for line in told.splitlines()[1:] for left in english_left(line.split(",", 5)[5])]
    assert "据列名" in told


def test_a_name_that_another_file_uses_is_kept_in_every_language(folder):
    from geofit.data.languages import ZH

    found = import_files([folder / name for name in FILES], folder / "s.toml", language=ZH)
    assert "base of clay" in found.site.horizons
    assert "clay底界" not in found.site.horizons


def kinds_of(folder, **files):
    paths = []
    for name, text in files.items():
        (folder / f"{name}.csv").write_text(text)
        paths.append(folder / f"{name}.csv")
    done = import_files(paths, folder / "site.toml")
    mapping = (folder / "site_mapping.toml").read_text("utf-8")
    return done, mapping


PLACES = "B1,500100,3100200,50\nB2,500300,3100250,55\nB3,500400,3100260,44\nB4,500440,3100300,41\n"


@pytest.mark.parametrize("name", ["picks", "T2_points", "contacts"])
def test_points_with_their_holes_are_no_collars_where_the_file_says_so(tmp_path, name):
    done, mapping = kinds_of(tmp_path, **{name: "hole,x,y,z\n" + PLACES})
    assert 'kind = "picks"' in mapping
    assert [len(points) for points in done.site.horizons.values()] == [4]


@pytest.mark.parametrize("header", ["CollarID,X,Y,Z", "collar_id,x,y,z", "hole,x,y,z"])
def test_collars_are_found_by_the_name_of_their_holes(tmp_path, header):
    done, mapping = kinds_of(tmp_path, holes=header + "\n" + PLACES)
    assert 'kind = "collar"' in mapping
    assert len(done.site.holes) == 4


def test_a_table_of_degrees_names_the_remedy(tmp_path):
    done, _ = kinds_of(tmp_path, p="name,longitude,latitude,horizon\nB1,110.1,30.2,T2\nB2,110.2,30.3,T2\n")
    (issue,) = [issue for issue in done.issues if issue.severity == "error"]
    assert issue.reason.code == "io.file-in-degrees"
    assert issue.remedy.code == "io.name-grid-with-crs"


def test_warnings_are_shown_by_kind(capsys):
    from geofit.cli.console import print_issues
    from geofit.data.messages import message
    from geofit.data.site import ImportIssue

    many = [ImportIssue("a.csv", k, "", "", "warning", message("test.dull", "dull {k}", k=k)) for k in range(280)]
    print_issues(
        [
            *many,
            ImportIssue("a.csv", 7, "", "", "warning", message("test.grave", "grave")),
            ImportIssue("a.csv", 9, "", "", "error", message("test.bad", "bad")),
        ],
        "list.csv",
    )
    lines = capsys.readouterr().err.splitlines()
    assert [line.split(":")[-1].strip() for line in lines[1:]] == ["bad.", "grave.", "dull 0. (279 more like it)"]


def test_codes_that_differ_in_case_make_one_horizon(folder):
    log = "hole,from,to,rock\n" + "".join(
        f"B{i},0,{10 + i},{'Clay' if i % 2 else 'clay'}\nB{i},{10 + i},50,granite\n" for i in range(5)
    )
    (folder / "log.csv").write_text(log, encoding="utf-8")
    found = import_files([folder / name for name in ("collar.csv", "log.csv")], folder / "site.toml")
    assert {name: len(points) for name, points in found.site.horizons.items()} == {"base of clay": 5}
    (issue,) = [issue for issue in found.issues if issue.reason.code == "project.codes-differ-in-case"]
    assert issue.severity == "warning"
    assert 'base = ["clay", "Clay"]' in (folder / "site.toml").read_text(encoding="utf-8")


def test_depths_next_to_elevations_are_warned_of(folder):
    rows = "".join(f"B{i},{500000 + 40 * i},{3100000 + 30 * (i % 2)},200,{10 + i},T2\n" for i in range(5))
    (folder / "tops.csv").write_text("hole,x,y,z,depth_to_top,horizon\n" + rows, encoding="utf-8")
    found = import_files([folder / "tops.csv"], folder / "site.toml")
    assert [one.column for one in found.issues if one.reason.code == "io.depths-not-read"] == ["depth_to_top"]


def test_a_code_that_is_asked_for_twice_is_one_horizon(folder):
    files = [folder / name for name in ("collar.csv", "log.csv")]
    assert list(import_files(files, folder / "site.toml", base=("clay", "clay")).site.horizons) == ["base of clay"]
