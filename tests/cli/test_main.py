"""The command as a user runs it: files in, files, words and exit codes out."""

from __future__ import annotations

import contextlib
import csv
import hashlib
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from commands import run

from geofit.cli import console
from geofit.data.errors import Cancelled
from geofit.data.messages import message
from geofit.data.site import ImportIssue, Site
from geofit.project import run as run_horizons

WEST, SOUTH = 500_000.0, 3_100_000.0


def write_picks(path: Path, extra: str = "", names: tuple[str, ...] = ("T3/T2",)) -> Path:
    """A dense middle and a sparse rim on a gentle wave, for each horizon one layer."""
    rng = np.random.default_rng(3)
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(["x", "y", "z", "surface", "section", "hole"])
        for layer, name in enumerate(names):
            for i in range(5):
                for y in np.linspace(20, 580, 12):
                    x = 260 + 20 * i
                    writer.writerow([WEST + x, SOUTH + y, f"{height(x, y) - 40 * layer:.4f}", name, f"S{i + 1}", ""])
            for i, (x, y) in enumerate(rng.uniform((0, 0), (600, 600), (60, 2))):
                if not 230 < x < 370:
                    z = height(x, y) - 40 * layer + rng.normal(0, 0.03)
                    writer.writerow([WEST + x, SOUTH + y, f"{z:.4f}", name, "", f"ZK{i}"])
        stream.write(extra)
    return path


def height(x, y):
    return 1500 + 0.05 * x + 4 * np.sin(x / 140) * np.cos(y / 170)


@pytest.fixture
def picks(tmp_path) -> Path:
    return write_picks(tmp_path / "picks.csv")


@pytest.fixture(scope="module")
def fitted(tmp_path_factory) -> Path:
    """One run for the tests that only look at its files."""
    folder = tmp_path_factory.mktemp("fitted")
    picks = write_picks(folder / "picks.csv", f"{WEST + 5},{SOUTH + 5},abc,T3/T2,,ZK99\n")
    done = subprocess.run(
        [sys.executable, "-m", "geofit", "fit", picks, "--out", folder / "out", "--epsilon", "0.5", "--json"],
        capture_output=True, text=True, check=False, encoding="utf-8",
    )  # fmt: skip
    (folder / "stdout").write_text(done.stdout, encoding="utf-8")
    (folder / "stderr").write_text(done.stderr, encoding="utf-8")
    assert done.returncode == 0, done.stderr
    return folder


def test_a_fit_leaves_every_file_whole(fitted):
    names = sorted(path.name for path in (fitted / "out").iterdir())
    assert names == [
        "T3_T2.json", "T3_T2.png", "T3_T2.step", "T3_T2_residuals.csv",
        "import_issues.csv", "report.html", "report.json", "site.png",
    ]  # fmt: skip
    assert "END-ISO-10303-21;" in (fitted / "out" / "T3_T2.step").read_text(encoding="utf-8")[-200:]


def test_report_writes_html_pdf_and_json_of_one_run(picks, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    code, _, err = run(monkeypatch, capsys, "report", picks, "--lang", "en", "--out", tmp_path / "o")
    assert code == 0, err
    data = json.loads((tmp_path / "o" / "report.json").read_text(encoding="utf-8"))
    assert (data["date"], data["horizons"][0]["verdict"]) == ("2023-11-14", "PASS")
    assert data["horizons"][0]["prediction"]["left_out"]
    assert data["horizons"][0]["read_back"]["valid"] is True
    digest = hashlib.sha256((tmp_path / "o" / "T3_T2.step").read_bytes()).hexdigest()
    assert data["horizons"][0]["read_back"]["sha256"] == digest
    assert (tmp_path / "o" / "report.pdf").read_bytes().startswith(b"%PDF-")
    assert "2023-11-14" in (tmp_path / "o" / "report.html").read_text(encoding="utf-8")
    code, _, err = run(monkeypatch, capsys, "report", picks, "--lang", "fr", "--out", tmp_path / "p")
    assert code == 2
    assert "zh" in err


def test_the_json_agrees_with_the_residual_table_and_the_files(fitted):
    data = json.loads((fitted / "out" / "T3_T2.json").read_text(encoding="utf-8"))
    with (fitted / "out" / "T3_T2_residuals.csv").open(encoding="utf-8-sig", newline="") as stream:
        rows = list(csv.DictReader(stream))
    d = np.array([float(row["residual_m"]) for row in rows])
    assert data["n_points"] == len(rows)
    assert data["sigma"] == pytest.approx(np.sqrt((d**2).sum() / (len(d) - 1)), abs=1e-8)
    assert data["n_core"] == sum(row["exact"] == "yes" for row in rows) > 0
    assert data["read_back"]["core_max_abs"] <= 1e-6
    assert data["read_back"]["valid"] is True
    step = fitted / "out" / "T3_T2.step"
    assert data["read_back"]["bytes"] == step.stat().st_size
    assert data["read_back"]["sha256"] == hashlib.sha256(step.read_bytes()).hexdigest()
    digest = hashlib.sha256((fitted / "picks.csv").read_bytes()).hexdigest()
    assert [(one["file"], one["sha256"]) for one in data["inputs"]] == [("picks.csv", digest)]


def test_json_alone_stands_on_stdout(fitted):
    data = json.loads((fitted / "stdout").read_text(encoding="utf-8"))
    assert [horizon["horizon"] for horizon in data["horizons"]] == ["T3/T2"]
    assert data["failures"] == {}


def test_a_bad_row_is_named_counted_and_listed(fitted):
    told = (fitted / "stderr").read_text(encoding="utf-8")
    read, used, listed = map(int, re.search(r"(\d+) read = (\d+) used \+ (\d+) listed", told).groups())
    assert read == used + listed
    assert listed == 1
    row = len((fitted / "picks.csv").read_text(encoding="utf-8").splitlines())
    assert f"picks.csv, row {row}, column 'z', value 'abc'" in told
    with (fitted / "out" / "import_issues.csv").open(encoding="utf-8-sig", newline="") as stream:
        assert [r["row"] for r in csv.DictReader(stream) if r["severity"] == "error"] == [str(row)]


def test_nothing_but_text_goes_into_a_pipe(fitted):
    assert "\x1b" not in (fitted / "stderr").read_text(encoding="utf-8")


def test_check_measures_any_step_surface(fitted, monkeypatch, capsys):
    step, picks = fitted / "out" / "T3_T2.step", fitted / "picks.csv"
    code, out, _ = run(monkeypatch, capsys, "check", step, picks, "--epsilon", "0.5", "--json")
    data = json.loads(out)
    known = json.loads((fitted / "out" / "T3_T2.json").read_text(encoding="utf-8"))
    assert (code, data["verdict"]) == (0, "PASS")
    assert data["sigma"] == pytest.approx(known["sigma"], abs=1e-6)
    code, out, _ = run(monkeypatch, capsys, "check", step, picks, "--epsilon", "1e-9")
    assert code == 1
    assert "FAIL" in out


def test_info_tells_points_and_step_apart(fitted, monkeypatch, capsys):
    code, out, _ = run(monkeypatch, capsys, "info", fitted / "picks.csv", "--json")
    assert code == 0
    assert [row["horizon"] for row in json.loads(out)] == ["T3/T2"]
    (row,) = json.loads(out)
    assert isinstance(row["points"], int)
    assert all(low < high for low, high in (row["west..east, m"], row["south..north, m"], row["z, m"]))
    code, out, _ = run(monkeypatch, capsys, "info", fitted / "out" / "T3_T2.step", "--json")
    known = json.loads((fitted / "out" / "T3_T2.json").read_text(encoding="utf-8"))
    assert [row["patches"] for row in json.loads(out)] == [len(known["patches"])]


def test_strict_brings_points_within_the_tolerance_that_noise_explains(tmp_path, monkeypatch, capsys):
    rng = np.random.default_rng(6)
    plan = rng.uniform(0, 400, (1200, 2))
    z = 900 + 5 * np.sin(plan[:, 0] / 90) + rng.normal(0, 0.05, 1200)
    source = tmp_path / "cloud.csv"
    rows = "\n".join(f"{x:.3f},{y:.3f},{h:.3f}" for x, y, h in np.column_stack([plan, z]))
    source.write_text(f"x,y,z\n{rows}\n", encoding="utf-8")
    beyond = {}
    for option in ([], ["--strict"]):
        out = tmp_path / ("strict" if option else "usual")
        run(monkeypatch, capsys, "fit", source, "--out", out, "--core", "none", *option)
        with next(out.glob("*_residuals.csv")).open(encoding="utf-8-sig", newline="") as stream:
            beyond[bool(option)] = max(abs(float(row["residual_m"])) for row in csv.DictReader(stream))
    assert beyond[False] > 0.1
    assert beyond[True] <= 0.1


def test_a_failing_horizon_ends_with_1(picks, tmp_path, monkeypatch, capsys):
    code, out, _ = run(
        monkeypatch, capsys, "fit", picks, "--out", tmp_path / "o", "--epsilon", "1e-7",
        "--max-iterations", "0", "--core", "none",
    )  # fmt: skip
    assert code == 1
    assert "FAIL" in out


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", ["picks.csv", "empty"]),
        ("a,b,c\n1,2,3\n", ["picks.csv"]),
        ("x,y,z\n1,2,abc\n", ["picks.csv", "column 'z'", "abc"]),
        ("x,y,z\n500000,3100000,1500\n", ["1 point", "at least 3"]),
    ],
)
def test_bad_input_ends_with_2_and_one_clear_line(content, words, tmp_path, monkeypatch, capsys):
    (tmp_path / "picks.csv").write_text(content, encoding="utf-8")
    code, out, err = run(monkeypatch, capsys, "fit", tmp_path / "picks.csv", "--out", tmp_path / "o")
    assert code == 2
    assert out == ""
    assert all(word in err for word in words), err
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--epsilon", "-1"], ["(epsilon) is -1", "above 0"]),
        (["--smoothing", "much"], ["(smoothing) is 'much'", "auto"]),
        (["--horizon", "T9"], ["no horizon 'T9'", "T3/T2"]),
        (["--boundary", "nowhere.csv"], ["nowhere.csv", "no such file"]),
        (["--seam", "loose"], ["loose", "tangent"]),
        (["--stream", "--dips", "fit"], ["--dips is not for clouds", "one surface"]),
        (["--stream", "--bands"], ["--bands is not for clouds", "one surface"]),
    ],
)
def test_bad_usage_ends_with_2_and_the_choices(arguments, words, picks, tmp_path, monkeypatch, capsys):
    code, _, err = run(monkeypatch, capsys, "fit", picks, "--out", tmp_path / "o", *arguments)
    assert code == 2
    assert all(word in err for word in words), err
    assert not list(tmp_path.glob("o/*.step"))


def test_one_horizon_that_cannot_be_fitted_does_not_take_the_others_along(tmp_path, monkeypatch, capsys):
    extra = f"{WEST},{SOUTH},1400,lost,,ZK1\n"
    picks = write_picks(tmp_path / "picks.csv", extra)
    code, out, err = run(monkeypatch, capsys, "fit", picks, "--out", tmp_path / "o")
    assert code == 2
    assert "T3/T2" in out
    assert "lost: 1 point given" in err
    assert (tmp_path / "o" / "T3_T2.step").exists()


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def heed_ctrl_c() -> None:
    """Undo what a shell does to the jobs it puts in the background: they, and all they start, ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.mark.skipif(os.name == "nt", reason="Windows sends no SIGINT to a single process")
def test_ctrl_c_leaves_no_half_written_file(tmp_path):
    picks = write_picks(tmp_path / "picks.csv", names=tuple(f"H{i}" for i in range(8)))
    process = subprocess.Popen(
        [sys.executable, "-m", "geofit", "fit", picks, "--out", tmp_path / "o"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=heed_ctrl_c,
    )  # fmt: skip
    # Interrupted when the first files are there, in the middle of the run.
    deadline = time.monotonic() + 120
    while not list(tmp_path.glob("o/*.step")) and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=120)
    assert process.returncode == 130, err
    assert "Traceback" not in err
    left = [path.name for path in (tmp_path / "o").iterdir()]
    assert not [name for name in left if ".part" in name or name.startswith(".")]
    for path in (tmp_path / "o").glob("*.step"):
        assert "END-ISO-10303-21;" in path.read_text(encoding="utf-8")[-200:]
    for path in (tmp_path / "o").glob("*.json"):
        json.loads(path.read_text(encoding="utf-8"))


def test_ctrl_c_that_a_library_swallows_stops_the_run_at_its_next_stage():
    def run() -> None:
        with console.listening() as progress:
            assert progress("fit", 0.1) is True
            with contextlib.suppress(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
            assert progress("pictures", 0.5) is False

    before = signal.getsignal(signal.SIGINT)
    heed_ctrl_c()
    try:
        with pytest.raises(KeyboardInterrupt):
            run()
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)


def test_a_run_in_the_background_goes_on_ignoring_ctrl_c():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with console.listening() as progress:
            signal.raise_signal(signal.SIGINT)
            assert progress("fit", 0.1) is True
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


def test_a_listener_that_says_stop_stops_the_run(picks, tmp_path):
    from geofit.io.picks import read_points

    found = read_points(picks)
    site = Site(name="picks", horizons=found.horizons)
    with pytest.raises(Cancelled):
        run_horizons.run_horizons(site, tmp_path / "o", progress=lambda stage, fraction: False)
    assert not list(tmp_path.glob("o/*.step"))


def test_a_missing_system_library_names_its_package(capsys):
    @console.with_exit_code
    def command() -> int:
        raise ImportError("libGL.so.1: cannot open shared object file: No such file or directory")

    with pytest.raises(Exception) as stop:  # noqa: PT011 - typer's Exit has moved between its releases
        command()
    assert stop.value.exit_code == 2
    assert "apt-get install libgl1" in capsys.readouterr().err


def test_other_import_errors_are_not_hidden():
    @console.with_exit_code
    def command() -> int:
        raise ImportError("No module named 'numpy'")

    with pytest.raises(ImportError, match="numpy"):
        command()


def test_only_the_first_findings_are_told(capsys):
    issues = [
        ImportIssue(
            "a.csv",
            i,
            "z",
            "?",
            "error",
            message(f"test.kind-{i}", "not a number"),
            message("test.text", "write metres"),
        )
        for i in range(9)
    ]
    console.print_issues(issues, "out/import_issues.csv")
    told = capsys.readouterr().err
    assert "Import: 9 errors. All of them: out/import_issues.csv" in told
    assert told.count("not a number") == console.FIRST_ISSUES
    assert "and 4 more" in told


def test_many_errors_do_not_hide_the_warnings(capsys):
    issues = [
        ImportIssue("a.csv", i, "z", "?", "error", message(f"test.kind-{i}", "not a number"), message("test.text", "x"))
        for i in range(7)
    ]
    far = message("test.far", "far off")
    issues.append(ImportIssue("a.csv", 9, "x", "0", "warning", far, message("test.text", "x")))
    console.print_issues(issues, "list.csv")
    told = capsys.readouterr().err
    assert "... and 2 more errors." in told
    assert "warning: a.csv, row 9, column 'x', value '0': far off" in told


def test_what_no_file_lists_is_printed_in_full(capsys):
    bad, guess = message("test.bad", "bad"), message("test.guess", "a guess")
    issues = [ImportIssue("a.csv", row, "z", "?", "error", bad) for row in range(2, 22)]
    console.list_issues([*issues, *(ImportIssue("a.csv", 0, c, "", "note", guess) for c in "xy")], None)
    told = capsys.readouterr().err
    assert all(f"row {row}, column 'z'" in told for row in range(2, 22))
    assert "note: a.csv, column 'x': a guess. (1 more like it)" in told


def test_an_error_comes_after_the_rows_that_are_its_reason(tmp_path, monkeypatch, capsys):
    """A reader that found no usable row hands over what it listed; a stale list is replaced."""
    survey, out = tmp_path / "dive.svx", tmp_path / "out"
    survey.write_text("*data diving from to tape compass fromdepth todepth\n1 2 10 90 -1 -3\n", encoding="utf-8")
    code, _, told = run(monkeypatch, capsys, "cave", survey, "--out", out)
    assert code == 2
    assert told.index("row 2, value '1 2 10 90 -1 -3'") < told.index("geofit: The survey dive.svx has no usable shot")
    with (out / "import_issues.csv").open(encoding="utf-8-sig", newline="") as stream:
        assert [row["row"] for row in csv.DictReader(stream)] == ["1", "2"]
    survey.write_text("1 2 10 90 0\n", encoding="utf-8")
    assert run(monkeypatch, capsys, "cave", survey, "--out", out, "--radius", "1", "--spacing", "1")[0] == 0
    assert len((out / "import_issues.csv").read_text(encoding="utf-8").splitlines()) == 1


def test_rows_are_listed_where_an_error_names_no_folder(tmp_path, monkeypatch, capsys):
    (tmp_path / "p.csv").write_text("x,y,z\n1,2,a\n2,3,b\n", encoding="utf-8")
    code, _, told = run(monkeypatch, capsys, "info", tmp_path / "p.csv")
    assert code == 0
    (tmp_path / "site.toml").write_text('[[horizon]]\nname = "T"\n[[picks]]\nfile = "p.csv"\nhorizon = "T"\n', "utf-8")
    code, _, told = run(monkeypatch, capsys, "info", tmp_path / "site.toml")
    assert code == 2
    assert told.index("p.csv, row 3, column 'z'") < told.index("geofit: ")


def test_info_says_what_tables_other_than_points_hold(tmp_path, monkeypatch, capsys):
    (tmp_path / "c.csv").write_text("hole,x,y,z,depth\nB1,500000,3100000,90,10\nB2,500100,3100000,91,12\n")
    (tmp_path / "s.csv").write_text("hole,depth,azimuth,dip\nB1,0,90,60\n")
    code, out, _ = run(monkeypatch, capsys, "info", tmp_path / "s.csv", "--json")
    assert (code, json.loads(out)[0]["kind"]) == (0, "survey")
    assert json.loads(out)[0]["rows"] == 1
    code, out, _ = run(monkeypatch, capsys, "info", tmp_path / "c.csv")
    assert code == 0
    assert "collar" in out
    assert "z = z" in out
    np.savez(tmp_path / "v.npz", volume=np.zeros((3, 3, 3)))
    code, _, told = run(monkeypatch, capsys, "info", tmp_path / "v.npz")
    assert code == 2
    assert "ZIP archive or an array of NumPy" in told
    code, _, told = run(monkeypatch, capsys, "info", tmp_path.parent / "." / tmp_path.name)
    assert code == 2
    assert tmp_path.name in told


def test_a_surface_through_collars_is_warned_of(tmp_path, monkeypatch, capsys):
    rows = "".join(f"B{i},{500000 + 40 * i},{3100000 + 37 * (i % 3)},{90 + i},10\n" for i in range(6))
    (tmp_path / "c.csv").write_text("hole,x,y,z,depth\n" + rows)
    _, _, told = run(monkeypatch, capsys, "fit", tmp_path / "c.csv", "--out", tmp_path / "out")
    assert "looks like collars" in told
    _, _, told = run(monkeypatch, capsys, "fit", tmp_path / "c.csv", "--z", "z", "--out", tmp_path / "out")
    assert "looks like collars" not in told


def test_points_in_one_line_leave_no_warning_of_a_library(tmp_path):
    rows = "".join(f"{10 * i},{20 * i},{5 + 3 * np.sin(i / 5):.3f}\n" for i in range(30))
    (tmp_path / "line.csv").write_text("x,y,z\n" + rows)
    done = subprocess.run(
        [sys.executable, "-m", "geofit", "fit", tmp_path / "line.csv", "--out", tmp_path / "out"],
        capture_output=True, text=True, check=False, encoding="utf-8",
    )  # fmt: skip
    assert done.returncode in (0, 1), done.stderr
    assert "Warning:" not in done.stderr
    assert "missing from the geological sections" not in done.stderr


def test_the_grid_of_a_table_is_in_the_results_and_must_count_in_metres(picks, tmp_path, monkeypatch, capsys):
    pytest.importorskip("pyproj")
    for wrong, word in (("EPSG:4326", "not a projected system"), ("EPSG:999999", "unknown")):
        code, _, told = run(monkeypatch, capsys, "fit", picks, "--crs", wrong, "--out", tmp_path / "out")
        assert (code, word in told) == (2, True), told
    code, out, told = run(
        monkeypatch, capsys, "fit", picks, "--crs", "EPSG:32650", "--dips", "fit", "--out", tmp_path / "out", "--json"
    )
    assert code == 0, told
    assert json.loads(out)["crs"] == "EPSG:32650"
    assert "dips are to be fitted, but none is measured" in told


def test_version_and_help(monkeypatch, capsys):
    import geofit

    assert run(monkeypatch, capsys, "--version")[:2] == (0, f"geofit {geofit.__version__}\n")
    code, out, _ = run(monkeypatch, capsys, "fit", "--help")
    assert code == 0
    for option in (
        "--epsilon",
        "--boundary",
        "--across",
        "--seam",
        "--core",
        "--frame",
        "--smoothing",
        "--json",
    ):
        assert option in out


def test_report_takes_chosen_horizons_and_its_title_block_from_options(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    picks = write_picks(tmp_path / "picks.csv")
    lines = picks.read_text(encoding="utf-8").splitlines()
    lines += [line.replace("T3/T2", "T2/T1") for line in lines[1:]]
    picks.write_text("\n".join(lines) + "\n", encoding="utf-8")
    options = ("--project", "P-7", "--client", "River Company", "--document", "D-1", "--status", "issued")
    code, out, err = run(
        monkeypatch, capsys, "report", picks, "--horizon", "T2/T1", *options, "--author", "Li Wen",
        "--revision", "A:First issue", "--json", "--out", tmp_path / "o",
    )  # fmt: skip
    assert code == 0, err
    data = json.loads((tmp_path / "o" / "report.json").read_text(encoding="utf-8"))
    assert [one["horizon"] for one in data["horizons"]] == ["T2/T1"]
    title = data["title"]
    assert [title[key] for key in ("project", "client", "document", "status", "author")] == [
        "P-7", "River Company", "D-1", "issued", "Li Wen",
    ]  # fmt: skip
    revision = {"mark": "A", "date": "2023-11-14", "text": "First issue", "author": "Li Wen"}
    assert title["revisions"] == [revision]
    printed = json.loads(out)
    assert {key: printed[key] for key in data} == data
    page = (tmp_path / "o" / "report.html").read_text(encoding="utf-8")
    assert all(word in page for word in ("P-7", "River Company", "D-1", "First issue"))
    code, _, err = run(monkeypatch, capsys, "report", picks, "--horizon", "T9", "--out", tmp_path / "p")
    assert (code, "T2/T1" in err) == (2, True)


def test_points_outside_a_concave_area_are_named_and_no_file_states_another_sigma_than_its_own(
    tmp_path, monkeypatch, capsys
):
    write_picks(tmp_path / "picks.csv")
    site = tmp_path / "site.toml"
    ring = ((0, 0), (620, 0), (620, 620), (450, 620), (310, 400), (180, 620), (0, 620))
    corners = "".join(f"{WEST + x},{SOUTH + y}\n" for x, y in ring)
    (tmp_path / "area.csv").write_text(f"x,y\n{corners}")
    site.write_text('[picks]\nfile = "picks.csv"\n[boundary]\nfile = "area.csv"\n', encoding="utf-8")
    from geofit.cad.step import read_shapes, read_step, write_step
    from geofit.fitting.judge import judge
    from geofit.io.site_file import read_site

    code, _, err = run(monkeypatch, capsys, "fit", site, "--out", tmp_path / "o")
    assert code == 0, err
    step, again = tmp_path / "o" / "T3_T2.step", tmp_path / "again.step"
    code, _, err = run(
        monkeypatch, capsys, "export", step, "--to", "step", "--out", again, "--points", site, "--certificate"
    )
    assert code == 0, err
    assert "points outside the surface's outline" in err
    assert "picks.csv" in err
    stated = [float(read_shapes(path)[0].attributes["sigma_m"]) for path in (step, again)]
    assert stated[1] == pytest.approx(stated[0], rel=1e-5)
    _, text, _ = run(monkeypatch, capsys, "check", again, site, "--json")
    assert json.loads(text)["sigma"] == pytest.approx(stated[1], rel=1e-5)
    (beyond,) = [one for one in json.loads(text)["checks"] if one["name"] == "beyond the surface"]
    assert beyond["value"] > 0
    (surface,) = read_step(again).values()
    (points,) = read_site(site).horizons.values()
    (back,) = write_step({"T3/T2": judge(surface, points)}, tmp_path / "judged.step").values()
    assert back.sigma == pytest.approx(stated[1], rel=1e-5)
    (check,) = [check for check in back.checks if check.name == "read-back attributes"]
    assert check.passed


def test_step_files_state_origin_author_and_certificate(tmp_path, monkeypatch, capsys):
    picks = write_picks(tmp_path / "picks.csv", names=("T3/T2", "T2/T1"))
    site = tmp_path / "site.toml"
    site.write_text(
        '[site]\ndatum = [499000, 3099000, 100]\n\n[report]\nauthor = "Li Wen"\n\n[picks]\nfile = "picks.csv"\n',
        encoding="utf-8",
    )
    from geofit.cad.step import read_shapes
    from geofit.cad.step_origin import offset_at

    def offset(path):
        return offset_at(read_shapes(path)[0].attributes).tolist()

    out = tmp_path / "o"
    arguments = ("fit", site, "--out", out, "--horizon", "T3/T2", "--origin", "datum", "--certificate")
    code, _, err = run(monkeypatch, capsys, *arguments, "--organisation", "Dam Office")
    assert code == 0, err
    step = out / "T3_T2.step"
    assert offset(step) == [499_000.0, 3_099_000.0, 100.0]
    head = step.read_text("ascii").split("ENDSEC;")[0].replace("\n", "")
    assert "('Li Wen'),('Dam Office')" in head, "the author is that of the site's report"
    assert (out / "T3_T2_certificate.pdf").read_bytes().startswith(b"%PDF")

    # The same file about another zero; with the points, it states sigma as the fit did.
    local = tmp_path / "local.step"
    code, _, err = run(
        monkeypatch, capsys, "export", step, "--to", "step", "--out", local, "--points", site, "--origin", "local",
        "--certificate", "--lang", "en",
    )  # fmt: skip
    assert code == 0, err
    (before,), (after,) = read_shapes(step), read_shapes(local)
    assert offset(local) == [500_000.0, 3_100_000.0, 0.0]
    assert float(after.attributes["sigma_m"]) == pytest.approx(float(before.attributes["sigma_m"]), rel=1e-4)
    assert after.attributes["data_sha256"] == before.attributes["data_sha256"]
    assert (tmp_path / "local_certificate.pdf").is_file()

    # Measured against the points in map coordinates, both are one surface.
    for path in (step, local):
        code, text, _ = run(monkeypatch, capsys, "check", path, picks, "--horizon", "T3/T2", "--json")
        assert json.loads(text)["sigma"] == pytest.approx(float(before.attributes["sigma_m"]), rel=1e-4)
    for arguments, words in (
        (("fit", picks, "--out", out, "--origin", "datum"), "states no project datum"),
        # Before any file is read.
        *(
            (("fit", "none.csv", "--out", out, "--origin", word), f"The origin '{word}' is unknown")
            for word in ("1,2", "nan,0,0", "0,0,inf", "here")
        ),
        (
            ("export", step, "--to", "obj", "--out", tmp_path / "x.obj", "--origin", "local"),
            "--origin is for STEP files",
        ),
    ):
        code, _, err = run(monkeypatch, capsys, *arguments)
        assert code == 2
        assert words in err
