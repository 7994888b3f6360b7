"""Tables as they come from practice: each defect is listed, and what is read is what was measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.io import read_boreholes, read_points, take_contacts
from geofit.io.mapping import ColumnMapping
from geofit.io.preview import preview_file
from geofit.project.importing import import_files

COLLAR, SURVEY, LOG = (
    ("hole", "x", "y", "z", "depth"),
    ("hole", "depth", "azimuth", "dip"),
    ("hole", "from", "to", "code"),
)


@dataclass
class Campaign:
    """Vertical holes through a clay whose base is a plane 20 m below the ground, a plane too."""

    xy: NDArray[np.float64]
    z: NDArray[np.float64]

    @property
    def names(self) -> list[str]:
        return [f"ZK{i:03d}" for i in range(len(self.z))]

    def collars(self) -> list[tuple[object, ...]]:
        return [
            (name, *(round(float(part), 2) for part in (x, y, z)), 97.5)
            for name, (x, y), z in zip(self.names, self.xy, self.z, strict=True)
        ]

    def log(self) -> list[tuple[object, ...]]:
        return [row for name in self.names for row in ((name, 0.0, 20.0, "clay"), (name, 20.0, 97.5, "rock"))]


@pytest.fixture(params=[1, 2])
def campaign(request) -> Campaign:
    rng = np.random.default_rng(request.param)
    xy = np.array([501000.0, 3101000.0]) + rng.uniform(0, 2000, (40, 2))
    return Campaign(xy, 1200 + 0.03 * (xy[:, 0] - 501000) + rng.normal(0, 1.0, 40))


def table(header, rows, sep=","):
    return "".join(sep.join(map(str, row)) + "\n" for row in (header, *rows))


def codes(found):
    return {issue.reason.code for issue in found.issues if issue.severity != "note"}


def of(found, code):
    return [issue for issue in found.issues if issue.reason.code == code]


@pytest.fixture
def read(write, campaign):
    """Return a function that reads the campaign with some tables changed."""

    def boreholes(collars=None, survey=None, log=None, **options):
        return read_boreholes(
            write(collars or table(COLLAR, campaign.collars()), "collar.csv"),
            write(survey, "survey.csv") if survey else None,
            [write(log or table(LOG, campaign.log()), "log.csv")],
            **options,
        )

    return boreholes


def test_a_clean_campaign_has_no_warning(read, campaign):
    found = read()
    assert codes(found) == set()
    np.testing.assert_allclose(
        take_contacts(found, base="clay").points.xyz[:, 2], np.round(campaign.z, 2) - 20, atol=1e-9
    )


# Places


@pytest.mark.parametrize(("axis", "by", "column"), [(0, 9000, "x"), (0, -10000, "x"), (1, 90000, "y")])
def test_a_wrong_digit_of_a_place_is_warned_of(read, campaign, axis, by, column):
    campaign.xy[7, axis] += by
    (far,) = of(read(), "io.row-far-from-others")
    assert (far.row, far.column) == (9, column)


@pytest.mark.parametrize("moved", [(-501000, -3101000), (48e6, 0)])
@pytest.mark.parametrize("every", [2, 3, 5])
def test_two_coordinate_systems_in_one_table_are_warned_of_once(read, campaign, moved, every):
    campaign.xy[::every] += moved
    (mixed,) = of(read(), "io.rows-of-another-system")
    assert mixed.reason.params["count"] == min(len(campaign.z[::every]), 40 - len(campaign.z[::every]))
    assert not of(read(), "io.row-far-from-others")


@pytest.mark.parametrize(("header", "warned"), [("X坐标,Y坐标", True), ("x,y", True), ("easting,northing", False)])
@pytest.mark.parametrize("zone", [0, 48e6])
def test_a_northing_under_x_is_warned_of(read, campaign, header, warned, zone):
    campaign.xy += [zone, 0]
    campaign.xy = campaign.xy[:, ::-1]
    found = read(f"hole,{header},z,depth\n" + table((), campaign.collars()))
    assert bool(of(found, "io.axes-like-exchanged")) is warned


def test_northings_taken_for_elevations_are_warned_of(read, campaign):
    rows = [(hole, z, x, y, depth) for hole, x, y, z, depth in campaign.collars()]
    (impossible,) = of(read("hole,x,y,z,depth\n" + table((), rows)), "io.elevations-not-possible")
    assert (impossible.severity, impossible.column) == ("warning", "z")
    assert not of(read(), "io.elevations-not-possible")


def test_latitudes_under_x_are_warned_of_too(write):
    rng = np.random.default_rng(0)
    rows = np.column_stack([rng.uniform(30, 30.02, 30), rng.uniform(110, 110.02, 30), rng.uniform(700, 800, 30)])
    path = write("x,y,z\n" + "".join("{:.6f},{:.6f},{:.2f}\n".format(*row) for row in rows.tolist()), "p.csv")
    assert len([one for one in read_points(path).issues if one.reason.code == "io.places-like-degrees"]) == 1


@pytest.mark.parametrize("first", [0, 1])
def test_half_of_the_collars_exchanged_is_warned_of(read, campaign, first):
    rows = [
        (n, *((y, x) if i % 2 == first else (x, y)), *rest) for i, (n, x, y, *rest) in enumerate(campaign.collars())
    ]
    (half,) = of(read(table(COLLAR, rows)), "io.half-of-axes-exchanged")
    assert (half.severity, half.reason.params["count"], half.reason.params["total"]) == ("warning", 20, 40)


def test_degrees_under_x_and_y_are_warned_of(read, campaign):
    campaign.xy = [105.0, 28.0] + (campaign.xy - [501000, 3101000]) / 1e5
    rows = [(name, *place, *rest[2:]) for (name, *rest), place in zip(campaign.collars(), campaign.xy, strict=True)]
    assert of(read(table(COLLAR, rows)), "io.places-like-degrees")
    metres = [(name, round(x, 2), round(y, 2), *rest) for name, x, y, *rest in rows]
    assert not of(read(table(COLLAR, metres)), "io.places-like-degrees")


def test_a_hole_far_north_of_a_core_in_a_local_grid_is_not_exchanged(write):
    rng = np.random.default_rng(4)
    places = [*(rng.uniform(-50, 50, (40, 2)) + np.array([500, 0])), (0.0, 1000.0)]
    found = read_boreholes(
        write("hole,x,y,z\n" + "".join(f"B{i},{x:.1f},{y:.1f},9\n" for i, (x, y) in enumerate(places)))
    )
    assert len(found.holes) == 41


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("layout", ["core and rim", "steps out", "two groups", "line"])
def test_sound_layouts_on_a_hillside_have_no_warning(write, layout, seed):
    rng = np.random.default_rng(seed)
    xy = {
        "core and rim": np.concatenate((rng.uniform(-100, 100, (80, 2)), rng.uniform(-2000, 2000, (12, 2)))),
        "steps out": np.concatenate((rng.uniform(-150, 150, (80, 2)), [(900, 700), (-800, 900), (-700, -1200)])),
        "two groups": np.concatenate(
            (rng.normal(0, 150, (60, 2)), rng.normal(0, 150, (20, 2)) + np.array([2500, 800]))
        ),
        "line": np.column_stack((np.sort(rng.uniform(0, 9000, 60)), rng.normal(0, 30, 60))),
    }[layout]
    z = 1200 + 0.25 * xy[:, 0] + 40 * np.sin(xy[:, 1] / 400) + 15 * np.sin(xy[:, 0] / 150)
    rows = [(f"B{i}", *(round(float(part), 2) for part in row), 50) for i, row in enumerate(np.c_[xy + 501000, z])]
    assert codes(read_boreholes(write(table(COLLAR, rows)))) == set()


# Elevations of collars


@pytest.mark.parametrize("by", [100, -1000, 2700])
def test_a_wrong_elevation_of_a_collar_is_warned_of(read, campaign, by):
    campaign.z[7] += by
    (off,) = of(read(), "io.collar-off-neighbours")
    assert off.row == 9
    assert off.reason.params["height"] == pytest.approx(by, abs=60)


@pytest.mark.parametrize("extreme", [9999.0, 99999.0, -1e6])
def test_an_extreme_elevation_does_not_hide_other_wrong_ones(read, campaign, extreme):
    collars = campaign.collars()
    for i, z in ((7, -99.0), (20, 0.0), (33, extreme)):
        collars[i] = (*collars[i][:3], z, collars[i][4])
    found = of(read(table(COLLAR, collars)), "io.collar-off-neighbours")
    assert [issue.row for issue in found] == [9, 22, 35]


def test_a_row_between_blanks_with_an_empty_cell_is_not_shifted(read, campaign):
    rows = campaign.collars()
    rows[5] = (*rows[5][:3], "", rows[5][4])
    found = read(table(COLLAR, rows, sep="  "))
    assert [(issue.row, issue.severity) for issue in of(found, "io.row-cells-differ")] == [(7, "error")]
    assert [hole.name for hole in found.holes] == [name for name in campaign.names if name != "ZK005"]
    assert found.counts[0].listed == 1


@pytest.mark.parametrize("huge", ["-3.4028235e+38", "3.4028234663852886E38", "1e+32"])
def test_a_huge_elevation_is_a_mark_for_no_data(read, campaign, huge):
    collars = campaign.collars()
    collars[3] = (*collars[3][:3], huge, collars[3][4])
    found = read(table(COLLAR, collars))
    assert [issue.row for issue in of(found, "io.cell-marks-no-data")] == [5]
    assert len(found.holes) == len(collars) - 1


def test_many_elevations_in_feet_are_one_warning(read, campaign):
    campaign.z[::5] /= 0.3048
    found = read()
    assert len(of(found, "io.collars-off-neighbours")) == 1
    assert not of(found, "io.collar-off-neighbours")


def site_on_ground(write, campaign, offset=0.0):
    """Write a site whose ground is the plane of the collars, lifted by an offset."""
    heights = " ".join(f"{1200 + offset + 0.03 * (100 * j):g}" for j in range(-1, 23))
    ground = "ncols 24\nnrows 24\nxllcenter 500900\nyllcenter 3100900\ncellsize 100\n" + (heights + "\n") * 24
    names = {"collar.csv": table(COLLAR, campaign.collars()), "log.csv": table(LOG, campaign.log()), "dem.asc": ground}
    return [write(text, name) for name, text in names.items()]


def test_a_collar_off_the_ground_is_warned_of(write, campaign, tmp_path):
    campaign.z[[3, 9]] += [40, -1200]
    found = import_files(site_on_ground(write, campaign), tmp_path / "site.toml")
    assert [issue.row for issue in of(found, "io.collar-off-ground")] == [5, 11]
    assert not of(found, "io.collars-off-ground")


def test_collars_that_are_all_off_the_ground_are_one_warning(write, campaign, tmp_path):
    found = import_files(site_on_ground(write, campaign, 35.0), tmp_path / "site.toml")
    (off,) = of(found, "io.collars-off-ground")
    assert off.reason.params["height"] == pytest.approx(-35, abs=2)
    assert not of(found, "io.collar-off-ground")


# Surveys


def test_angles_from_the_vertical_are_warned_of(read, campaign):
    rows = [(name, 0, 10 * i, i % 20) for i, name in enumerate(campaign.names[:30])]
    assert of(read(survey=table(SURVEY, rows)), "io.dips-like-from-vertical")
    steep = [(name, depth, azimuth, 90 - dip) for name, depth, azimuth, dip in rows]
    assert not of(read(survey=table(SURVEY, steep)), "io.dips-like-from-vertical")


def test_a_station_with_a_lost_digit_is_warned_of(read):
    found = read(survey=table(SURVEY, [("ZK001", 0, 90, 85), ("ZK001", 50, 91, 8.4)]))
    (turn,) = of(found, "io.hole-turns-sharply")
    assert (turn.severity, turn.row) == ("warning", 3)


def test_a_station_below_the_end_of_its_hole_is_warned_of_once_a_hole(read):
    rows = [(name, depth, 90, 85) for name in ("ZK001", "ZK002") for depth in (0, 97.9, 150, 300)]
    assert [issue.row for issue in of(read(survey=table(SURVEY, rows)), "io.station-beyond-hole")] == [4, 8]


def test_the_attitude_of_the_collar_begins_a_survey(read, campaign):
    collars = table((*COLLAR, "azimuth", "dip"), [(*row, 90, 60) for row in campaign.collars()])
    found = read(collars, table(SURVEY, [("ZK001", 60, 90, 80)]))
    assert codes(found) == {"io.dip-sign-taken"}
    whole = read(table(COLLAR, campaign.collars()), table(SURVEY, [("ZK001", 0, 90, 60), ("ZK001", 60, 90, 80)]))
    np.testing.assert_allclose(found.paths["ZK001"].at(50.0), whole.paths["ZK001"].at(50.0))


@pytest.mark.parametrize(
    ("angles", "warned"),
    [
        ({"azimuth": 45, "inclination": -60}, ("azimuth", "dip", "inclination")),
        ({"tool_az": 45, "dip": -60}, ("dip", "azimuth", "tool_az")),
        ({"azimuth": 0, "remark": "ok"}, None),
        ({"dip": -90, "remark": "ok"}, None),
        ({"azimuth": 45, "dip": -60}, None),
    ],
)
def test_a_collar_table_with_half_of_an_attitude_is_warned_of(read, campaign, angles, warned):
    rows = [(*row, *angles.values()) for row in campaign.collars()]
    found = of(read(table((*COLLAR, *angles), rows)), "io.half-attitude")
    assert len(found) == (warned is not None)
    if warned:
        column, missing, unread = warned
        assert (found[0].severity, found[0].column, found[0].reason.params["missing"]) == ("warning", column, missing)
        assert unread in str(found[0].remedy)


def test_holes_without_any_survey_are_noted(read, campaign):
    (note,) = of(read(), "io.holes-taken-as-vertical")
    assert note.reason.params["count"] == len(campaign.z)


def test_vertical_holes_of_one_station_are_one_note(read, campaign):
    rows = [(name, 0, 0, 70 if name == "ZK003" else 90) for name in campaign.names]
    found = read(survey=table(SURVEY, rows))
    assert [issue.row for issue in of(found, "io.hole-of-one-station")] == [5]
    (note,) = of(found, "io.holes-of-one-vertical-station")
    assert note.reason.params["count"] == len(campaign.z) - 1


# Names


@pytest.mark.parametrize("written", ["{0}", "{0}.0", "ZK{0}", "zk-{0:03d}", "ZK_{0:03d}", "ZK {0}"])
def test_zeros_blanks_and_hyphens_of_names_do_not_matter(read, campaign, written):
    collars = campaign.collars()
    if written.startswith("{0}"):  # a spreadsheet took 007 for 7, another program that for 7.0
        collars = [(name[2:], *rest) for name, *rest in collars]
    log = [(written.format(int(name[2:])), *rest) for name, *rest in campaign.log()]
    found = read(table(COLLAR, collars), log=table(LOG, log))
    assert codes(found) == {"io.names-matched-by-marks"}
    assert len(take_contacts(found, base="clay").points) == len(campaign.z)


def test_numbers_in_names_stay_apart(read, write):
    """BH1-1 is not BH11, and the log of a collar that was refused belongs to no other hole."""
    found = read_boreholes(
        write("hole,x,y,z\nBH11,0,0,9\nBH-2,a,0,9\nBH2,5,0,9\n", "collar.csv"),
        None,
        [write("hole,from,to,code\nBH1-1,0,2,A\nBH-2,0,2,A\nBH11,0,2,A\n", "log.csv")],
    )
    assert [issue.row for issue in of(found, "io.name-unknown")] == [2, 3]


def test_the_log_of_a_refused_collar_refers_to_its_row(read, campaign):
    collars = [(*row[:3], "", row[4]) if i == 4 else row for i, row in enumerate(campaign.collars())]
    log = [(name.replace("ZK", "ZK-"), *rest) for name, *rest in campaign.log()]
    unknown = of(read(table(COLLAR, collars), log=table(LOG, log)), "io.name-unknown")
    assert [issue.remedy.code for issue in unknown] == ["io.referred-row-not-used"] * 2


@pytest.mark.parametrize("again", ["zk004", "ZK-004", "ZK4"])
def test_two_collars_of_one_name_are_warned_of(read, campaign, again):
    _, x, *rest = campaign.collars()[4]
    found = read(table(COLLAR, [*campaign.collars(), (again, x + 30, *rest)]))
    (alike,) = of(found, "io.hole-named-alike")
    assert (alike.row, alike.reason.params["row"]) == (42, 6)


# Numbers


@pytest.mark.parametrize("mark", ["n/a", "-", "NaN", "?", "k.A.", "-9999", "0"])
def test_a_hole_of_unknown_depth_is_used(read, campaign, mark):
    collars = [(*row[:4], mark if i % 5 == 0 else row[4]) for i, row in enumerate(campaign.collars())]
    found = read(table(COLLAR, collars))
    assert codes(found) == ({"io.hole-depth-zero"} if mark == "0" else set())
    assert len(take_contacts(found, base="clay").points) == len(campaign.z)


@pytest.mark.parametrize(
    ("row", "mark"),
    [
        ("ZK1;501111;3101111;1.204;97,8", ","),
        ("ZK1;501.111;3.101.111;1.204;97,8", ","),
        ("ZK1;501,111;3,101,111;1,204;97.8", "."),
        ("ZK1;501111,5;3101111,5;1204,500;97,8", ","),
    ],
)
def test_thousands_are_not_taken_for_fractions(write, row, mark):
    """A number that can be read in two ways is not used; it does not make the other mark the decimal one."""
    path = write("hole;x;y;z;depth\n" + row + "\n", "collar.csv")
    (preview,) = preview_file(path)
    assert preview.decimal == mark
    if "500" in row:
        assert read_boreholes(path).ends == {"ZK1": 97.8}
    else:
        with pytest.raises(InputError) as error:
            read_boreholes(path)
        assert (error.value.code, error.value.column is None) == ("io.no-usable-row-because", False)


def test_an_optional_column_that_is_not_read_is_named(write):
    found = read_boreholes(write("hole;x;y;z;depth\n" + "".join(f"B{i};{i};5;9;9,5 m tief\n" for i in range(5))))
    assert [issue.column for issue in of(found, "io.optional-column-not-used")] == ["depth"]


# Intervals


def test_depths_that_run_upwards_are_not_elevations(read, campaign):
    rows = [(name, base, top, code) for name, top, base, code in campaign.log()]
    found = read(log=table(LOG, rows))
    assert codes(found) == {"io.interval-reversed"}
    rows = [
        (row[0], campaign.z[i // 2] - row[1], campaign.z[i // 2] - row[2], row[3])
        for i, row in enumerate(campaign.log())
    ]
    assert of(read(log=table(LOG, rows)), "io.limits-taken-elevations")


def test_negative_depths_are_named(read, campaign):
    found = read(log=table(LOG, [(name, -top, -base, code) for name, top, base, code in campaign.log()]))
    assert codes(found) == {"io.interval-starts-above-collar"}


@pytest.mark.parametrize("unit", [0.3048, 1 / 0.3048])
def test_logs_and_holes_of_two_units_are_warned_of(read, campaign, unit):
    found = read(log=table(LOG, [(name, top * unit, base * unit, code) for name, top, base, code in campaign.log()]))
    assert len(of(found, "io.log-of-other-unit")) == 1


# Headers


HEADS = {
    "titles": ("Project,Dam X\nClient,River Co\nHoles,40\n\n", "hole,x,y,z,depth\n"),
    "merged": ("Borehole,Coordinates,,,Final\n", "hole,x,y,z,depth\n"),
    "merged both ways": ("Hole,Coordinates,,,\n", ",X,Y,Z,Depth\n"),
    "units": ("Collars\n", "hole,x,y,z,depth\n-,m,m,m a.s.l.,m bgl\n"),
}


@pytest.mark.parametrize("head", HEADS)
def test_titles_and_headers_of_two_rows(read, campaign, head):
    found = read("".join(HEADS[head]) + table((), campaign.collars()).lstrip("\n"))
    assert codes(found) == set()
    assert len(take_contacts(found, base="clay").points) == len(campaign.z)


def test_a_units_row_with_words_behind_its_units(read, campaign):
    rows = [("", "ft bgl", "ft bgl", ""), *((a, top / 0.3048, base / 0.3048, c) for a, top, base, c in campaign.log())]
    found = read(log=table(LOG, rows))
    np.testing.assert_allclose(
        take_contacts(found, base="clay").points.xyz[:, 2], np.round(campaign.z, 2) - 20, atol=1e-9
    )


def test_a_first_row_of_words_is_not_a_header(write):
    """Neither a header with a nameless column nor a first row without numbers is taken for a title."""
    found = read_points(write("x,y,z,,remark\n1,2,n/a,,no core\n3,4,5\n6,7,8\n9,10,11\n"))
    assert [len(points) for points in found.horizons.values()] == [3]


def test_german_and_french_headers(write, campaign, tmp_path):
    for heads in (
        (
            "Bohrloch-Nr.;Ostwert [m];Nordwert [m];Ansatzhöhe (m ü. NN);Teufe (m)",
            "Bohrloch-Nr.;Tiefe von;Tiefe bis;Gestein",
        ),
        ("Sondage;X (m);Y (m);Z (m NGF);Profondeur", "Sondage;De;À;Formation"),
    ):
        rows = (campaign.collars(), campaign.log())
        files = [
            write(head + table((), part, ";").replace(".", ","), name, "cp1252")
            for head, part, name in zip(heads, rows, ("c.csv", "l.csv"), strict=True)
        ]
        found = import_files(files, tmp_path / f"{heads[0][:3]}.toml")
        assert {name: len(points) for name, points in found.site.horizons.items()} == {"base of clay": len(campaign.z)}


# Imports


def workbook(path, sheets, hidden=()):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
        sheet.sheet_state = "hidden" if name in hidden else "visible"
    book.save(path)
    return path


def test_a_sheet_of_notes_does_not_hide_the_other_sheets(campaign, tmp_path):
    notes = [("sheet", "of", "notes")]
    sheets = {"Notes": notes, "Collar": [COLLAR, *campaign.collars()], "Log": [LOG, *campaign.log()]}
    workbook(tmp_path / "site.xlsx", sheets)
    found = import_files([tmp_path / "site.xlsx"], tmp_path / "site.toml")
    assert {count.file: count.used for count in found.counts}["site.xlsx [Collar]"] == len(campaign.z)
    assert [issue.file for issue in of(found, "io.table-without-rows")] == ["site.xlsx [Notes]"]


def test_numbers_with_another_mark_are_named_as_the_reason(campaign, write, tmp_path):
    rows = [(name, *(f"{part}".replace(".", "'") for part in rest)) for name, *rest in campaign.collars()]
    found = import_files([write(table(COLLAR, rows), "collar.csv")], tmp_path / "site.toml")
    assert of(found, "io.file-without-numbers")


def test_rows_of_a_table_that_is_set_aside_are_listed(campaign, write, tmp_path):
    rows = [(*place, 80, 90, -5) for place in campaign.xy]
    files = [write(table(COLLAR, campaign.collars()), "c.csv"), write(table(LOG, campaign.log()), "l.csv")]
    dips = write(table(("x", "y", "z", "azimuth", "dip"), rows), "dips.csv")
    found = import_files([*files, dips], tmp_path / "site.toml")
    assert [issue.row for issue in of(found, "io.dip-out-of-range")] == list(range(2, len(rows) + 2))


def test_spellings_of_one_code_are_one_bed(campaign, write, tmp_path):
    spellings = ("Clay", "clay", "CLAY.", "clay ")
    rows = [(*row[:3], spellings[i % 4] if row[3] == "clay" else "rock") for i, row in enumerate(campaign.log())]
    files = [write(table(COLLAR, campaign.collars()), "c.csv"), write(table(LOG, rows), "l.csv")]
    found = import_files(files, tmp_path / "site.toml")
    assert [len(points) for points in found.site.horizons.values()] == [len(campaign.z)]
    assert len(of(found, "project.codes-differ-in-case")) == 1


def test_holes_in_two_collar_tables_are_warned_of(campaign, write, tmp_path):
    collars = campaign.collars()
    files = [write(table(COLLAR, part), name) for part, name in ((collars[:25], "a.csv"), (collars[25:], "b.csv"))]
    found = import_files([*files, write(table(LOG, campaign.log()), "log.csv")], tmp_path / "site.toml")
    (split,) = of(found, "io.holes-in-other-collars")
    assert (split.file, split.reason.params["count"]) == ("log.csv", 15)


@pytest.mark.parametrize("away", [0.0, 3.0])
def test_two_collar_tables_of_the_same_holes_are_warned_of(campaign, write, tmp_path, away):
    moved = [(name, x, y, round(z + away, 2), depth) for name, x, y, z, depth in campaign.collars()[:30]]
    tables = {"old.csv": (COLLAR, moved), "new.csv": (COLLAR, campaign.collars()), "log.csv": (LOG, campaign.log())}
    files = [write(table(header, rows), name) for name, (header, rows) in tables.items()]
    (shared,) = of(import_files(files, tmp_path / "site.toml"), "io.holes-in-two-collar-tables")
    assert (shared.file, shared.severity, shared.reason.params["count"]) == ("new.csv", "warning", 30)
    assert ("3.00 m" if away else "same place") in str(shared.reason)
    assert "logs are read with new.csv" in str(shared.reason)


def test_a_file_that_is_given_twice_is_read_once(campaign, write, tmp_path):
    file = write(table(COLLAR, campaign.collars()), "collar.csv")
    found = import_files([file, file, write(table(LOG, campaign.log()), "log.csv")], tmp_path / "site.toml")
    assert [one.file for one in of(found, "io.file-read-once")] == ["collar.csv"]
    assert len(found.site.holes) == len(campaign.z)


def test_a_hidden_sheet_is_not_used_and_its_rows_are_listed(campaign, tmp_path):
    old = [(name, x, y, z + 40, depth) for name, x, y, z, depth in campaign.collars()]
    sheets = {"Old": [COLLAR, *old], "Collar": [COLLAR, *campaign.collars()], "Log": [LOG, *campaign.log()]}
    file = workbook(tmp_path / "site.xlsx", sheets, hidden=("Old",))
    found = import_files([file], tmp_path / "site.toml")
    np.testing.assert_allclose([hole.xyz[0, 2] for hole in found.site.holes], np.round(campaign.z, 2))
    assert [(one.file, one.severity) for one in of(found, "io.sheet-hidden")] == [("site.xlsx [Old]", "warning")]
    assert {one.file: one.listed for one in found.counts}["site.xlsx [Old]"] == len(old)
    wanted = [ColumnMapping(file="site.xlsx", table="Old", kind="collar")]
    stated = import_files([file], tmp_path / "other.toml", mappings=wanted)
    assert not of(stated, "io.sheet-hidden")


# Names that stand once a block


def in_first_row(rows):
    seen = set()
    return [("" if row[0] in seen or seen.add(row[0]) else row[0], *row[1:]) for row in rows]


def with_survey(campaign):
    return [(name, depth, 0, 90) for name in campaign.names for depth in (0.0, 50.0, 90.0)]


@pytest.mark.parametrize("merged", [False, True])
def test_a_hole_named_in_its_first_row_only_has_the_rows_below(read, campaign, tmp_path, merged):
    log, survey = in_first_row(campaign.log()), in_first_row(with_survey(campaign))
    if merged:
        openpyxl = pytest.importorskip("openpyxl")
        book = openpyxl.Workbook()
        for row in (LOG, *log):
            book.active.append([cell if cell != "" else None for cell in row])
        for k in range(2, len(log) + 2, 2):
            book.active.merge_cells(start_row=k, end_row=k + 1, start_column=1, end_column=1)
        book.save(tmp_path / "log.xlsx")
        given = tmp_path / "log.xlsx"
        collars = tmp_path / "collar.csv"
        collars.write_text(table(COLLAR, campaign.collars()), encoding="utf-8")
        found = read_boreholes(collars, None, [given])
        assert of(found, "io.holes-from-above")[0].reason.params["count"] == 40
    else:
        found = read(survey=table(SURVEY, survey), log=table(LOG, log))
        assert [issue.reason.params["count"] for issue in of(found, "io.holes-from-above")] == [80, 40]
    assert codes(found) - {"io.dip-sign-taken"} == {"io.holes-from-above"}
    whole = read(survey=table(SURVEY, with_survey(campaign)))
    np.testing.assert_array_equal(
        take_contacts(found, base="clay").points.xyz, take_contacts(whole, base="clay").points.xyz
    )


def test_a_name_that_is_missing_among_others_is_not_made_up(read, campaign):
    log = campaign.log()
    log[31] = ("", *log[31][1:])
    found = read(log=table(LOG, log))
    (empty,) = of(found, "io.cell-empty")
    assert (empty.row, empty.column) == (33, "hole")


def test_a_block_that_lost_its_name_does_not_join_the_one_above(read, campaign):
    log = in_first_row(campaign.log())
    log[30] = ("", *log[30][1:])
    found = read(log=table(LOG, log))
    assert [issue.row for issue in of(found, "io.cell-empty")] == [32, 33]
    assert of(found, "io.holes-from-above")[0].reason.params["count"] == 39


def test_nor_does_it_join_a_shallow_hole(read, campaign):
    log = in_first_row(campaign.log())
    log[28:31] = [(campaign.names[14], 0.0, 5.0, "clay"), ("", 0.0, 20.0, "clay")]
    found = read(log=table(LOG, log))
    assert [issue.row for issue in of(found, "io.cell-empty")] == [31, 32]
