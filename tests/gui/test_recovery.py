"""kill -9 at any moment loses at most the command under way."""

from __future__ import annotations

import importlib.util
import json
import shutil
import subprocess
import sys
import zlib
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.project.building import make
from geofit.project.commands import ExcludeRows, MoveToPoint, RenameSite, SetSettings, SetSurface
from geofit.project.data_change import on_other_data
from geofit.project.document import Document
from geofit.project.journal import FORMAT, SessionJournal, unfinished
from geofit.project.named_points import excluded_names
from geofit.project.provenance import Row
from geofit.project.state import State

CHILD = Path(__file__).with_name("cut_off.py")
KILLS = 60


def child_module():
    spec = importlib.util.spec_from_file_location("cut_off", CHILD)
    module = importlib.util.module_from_spec(spec)
    sys.modules["cut_off"] = module
    spec.loader.exec_module(module)
    return module


cut_off = child_module()


def killed(journal: SessionJournal) -> Path:
    """Return a folder with the journals that the end of the process leaves: nobody holds them."""
    left = shutil.copytree(journal.path.parent, journal.path.parent / "killed")
    journal.end()
    return left


def states(seed: int, count: int):
    """States after 0, 1, ... ``count`` steps of a session, as an uninterrupted one has them."""
    player = cut_off.Player(None)
    found = [player.document.state]
    for step in cut_off.steps(seed):
        if len(found) > count:
            return found
        if player.play(step):
            found.append(player.document.state)
    raise AssertionError


@pytest.mark.skipif(not hasattr(__import__("os"), "fork"), reason="kill -9 is for Linux and macOS")
def test_a_session_killed_at_any_moment_comes_back(tmp_path):
    done = subprocess.run(
        [sys.executable, str(CHILD), str(tmp_path), str(KILLS), "100"],
        capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    killed = {int(pid): (int(seed), int(told)) for seed, told, pid in map(str.split, done.stdout.splitlines())}
    assert len(killed) == KILLS
    found = {int(one.path.name.split("-")[1]): one for one in unfinished(tmp_path)}
    lengths = set()
    for pid, (seed, told) in killed.items():
        expected = states(seed, told + 1)
        if pid not in found:
            # Nothing unsaved: the state was the first one again.
            assert expected[0] in expected[told:]
            continue
        session = found[pid]
        assert session.final in expected[told:], f"session {seed}: {told} steps acknowledged"
        assert session.base == expected[0]
        lengths.add(told)
    assert len(lengths) > KILLS // 4, "the sessions were not killed at different moments"
    assert set(tmp_path.glob("*.journal")) == {one.path for one in found.values()}


def test_a_journal_cut_after_any_byte_gives_a_prefix(tmp_path):
    player = cut_off.Player(None)
    journal = SessionJournal(tmp_path, player.document.state, Path("site.toml"), None)
    player.journal = journal
    expected = [player.document.state]
    for step in cut_off.steps(7):
        if player.play(step):
            expected.append(player.document.state)
        if len(expected) > 12:
            break
    data = journal.path.read_bytes()
    journal.end()
    assert not journal.path.exists()
    first = data.index(b"\n") + 1
    last = 0
    for cut in range(first, len(data) + 1, 7):
        path = tmp_path / "session-1-0.journal"
        path.write_bytes(data[:cut])
        whole = data[:cut].count(b"\n") - 1
        sessions = unfinished(tmp_path)
        if expected[whole] == expected[0]:
            assert not sessions
        else:
            assert sessions[0].final == expected[whole]
        assert whole >= last
        last = whole
    assert last >= 10


def test_a_damaged_line_ends_what_is_brought_back(tmp_path):
    document = Document()
    document.open(cut_off.tiny_site(), Path("site.toml"))
    journal = SessionJournal(tmp_path, document.state, Path("site.toml"), None)
    for name in "abc":
        command = RenameSite(name)
        command.redo(document)
        journal.done(command)
    data = journal.path.read_bytes()
    journal.end()
    place = data.rindex(b'"b"') + 1
    (tmp_path / "session-1-0.journal").write_bytes(data[:place] + b"x" + data[place + 1 :])
    (session,) = unfinished(tmp_path)
    assert session.final.name == "a"


def test_the_journal_of_a_living_session_is_left_alone(tmp_path):
    document = Document()
    document.open(cut_off.tiny_site(), Path("site.toml"))
    journal = SessionJournal(tmp_path, document.state, Path("site.toml"), None)
    command = RenameSite("here")
    command.redo(document)
    journal.done(command)
    assert unfinished(tmp_path) == []
    assert journal.path.is_file()
    journal.end()


def test_what_was_saved_is_not_offered(tmp_path):
    document = Document()
    document.open(cut_off.tiny_site(), Path("site.toml"))
    journal = SessionJournal(tmp_path, document.state, Path("site.toml"), None)
    command = RenameSite("saved")
    command.redo(document)
    journal.done(command)
    journal.saved(Path("a.geofit"), document.state)
    left = killed(journal)
    assert (left / journal.path.name).exists()
    assert unfinished(left) == []
    assert not (left / journal.path.name).exists()


def test_surfaces_come_back_to_the_last_bit(tmp_path):
    document = Document()
    document.open(cut_off.tiny_site(), Path("site.toml"))
    journal = SessionJournal(tmp_path, document.state, Path("site.toml"), None)

    def do(command):
        command.redo(document)
        journal.done(command)

    do(SetSettings("W", FitSettings(core="none", epsilon=0.05)))
    do(SetSurface(document.provenance("W")))
    do(MoveToPoint("W", 3, 0.5))
    provenance = document.state.provenances["W"]
    document.put(provenance, make(provenance, document.given_for(provenance)))

    (session,) = unfinished(killed(journal))
    again = Document()
    again.open(cut_off.tiny_site(), Path("site.toml"), session.base)
    for command in session.commands:
        command.redo(again)
    assert again.state == document.state
    (missing,) = again.missing()
    surface = make(missing, again.given_for(missing))
    for new, old in zip(surface.patches, document.surface("W").patches, strict=True):
        assert np.array_equal(new.control, old.control)


def test_states_of_two_sessions_differ():
    # The test above compares states: it must be able to tell them apart.
    found = states(3, 40)
    assert sum(a != b for a, b in pairwise(found)) > 30


def test_excluded_points_come_back_by_name_after_steps_that_were_undone_and_redone(tmp_path):
    document = Document()
    document.open(cut_off.tiny_site(), Path("site.toml"))
    document.become(replace(document.state, excluded={"W": frozenset([Row("picks.csv", 3)])}))
    read, base = document.read, document.state
    journal = SessionJournal(
        tmp_path, base, Path("site.toml"), Path("a.geofit"), State(), "ab12", excluded_names(base, read)
    )
    second = ExcludeRows("W", (Row("picks.csv", 7),))
    second.redo(document)
    journal.done(second, excluded_names(document.state, read))
    journal.undone()
    journal.redone()
    (session,) = unfinished(killed(journal))
    assert session.saved == State()
    assert session.digest == "ab12"
    assert session.names == excluded_names(document.state, read)
    # A line was inserted above, and the point of row 7 was corrected.
    points = read.horizons["W"]
    xyz = points.xyz.copy()
    xyz[5, 2] += 1.0
    moved = PointSet(xyz, file="picks.csv", row=points.row + 1)
    state, lost = on_other_data(session.final, session.names, replace(read, horizons={**read.horizons, "W": moved}))
    assert state.excluded == {"W": {Row("picks.csv", 4)}}
    assert [one.code for one in lost] == ["project.exclusion-lost"]


def test_a_journal_of_version_1_keeps_rows_by_their_numbers_and_says_so(tmp_path):
    data = line(head(version=1, state=Document().state.to_data())) + line({"do": RenameSite("x").to_data()})
    (tmp_path / "session-1-0.journal").write_bytes(data)
    (session,) = unfinished(tmp_path)
    assert session.names == {}
    site = replace(cut_off.tiny_site(), inputs={"picks.csv": "00"})
    state = replace(State.of_site(site), excluded={"W": frozenset([Row("picks.csv", 7)])})
    again, lost = on_other_data(state, session.names, site)
    assert again.excluded == state.excluded
    assert [one.code for one in lost] == ["project.exclusion-doubtful"]


def test_a_journal_that_cannot_be_closed_is_removed_all_the_same(tmp_path, monkeypatch):
    journal = SessionJournal(tmp_path, Document().state, None, None)

    def full(handle):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr("os.fsync", full)
        with pytest.raises(OSError, match="No space"):
            journal.done(RenameSite("x"))
    assert unfinished(tmp_path) == []
    journal.end()
    assert not journal.path.exists()


def line(record):
    text = record if isinstance(record, bytes) else json.dumps(record).encode()
    return b"%08x " % zlib.crc32(text) + text + b"\n"


def head(**changes):
    state = Document().state.to_data()
    return {"format": FORMAT, "version": 1, "site_file": None, "project_file": None, "state": state, **changes}


@pytest.mark.parametrize(
    "data",
    [
        line(head(version=3)),
        line(head(format="another")),
        b"0" + line(head())[1:],
        line(head()) + line({"undo": True}),
        line(head()) + line({"do": {"kind": "no such command"}}),
        line(head()) + line({"do": {"kind": "exclude"}}),
        line(head()) + line([1, 2]),
        line(head()) + line(b"no json"),
        line(head(state={})),
        line(head(site_file=7)),
        line([]),
        b"\xff\xfe\n\n",
    ],
    ids=["newer", "another format", "damaged", "undo of nothing", "unknown", "senseless", "a list", "no JSON",
         "no state", "a number for a path", "a list first", "bytes"],
)  # fmt: skip
def test_a_journal_that_cannot_be_read_is_kept_and_blocks_no_other(tmp_path, data, caplog):
    strange = tmp_path / "session-1-0.journal"
    strange.write_bytes(data)
    document = Document()
    journal = SessionJournal(tmp_path, document.state, Path("site.toml"), None)
    journal.done(RenameSite("another"))
    left = killed(journal)
    (session,) = unfinished(left)
    assert session.final.name == "another"
    assert not (left / strange.name).exists()
    kept = left / "session-1-0.journal.unreadable"
    assert kept.read_bytes() == data
    assert str(kept) in caplog.text
    assert len(unfinished(left)) == 1


def test_a_session_that_was_cut_off_within_its_first_line_leaves_nothing(tmp_path):
    for k, data in enumerate((b"", line(head())[:-1])):
        (tmp_path / f"session-1-{k}.journal").write_bytes(data)
    assert unfinished(tmp_path) == []
    assert list(tmp_path.iterdir()) == []
