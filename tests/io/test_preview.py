"""Previews and mappings: guesses with their confidence, overruled, saved and used again."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from geofit.data.errors import InputError
from geofit.io import read_points, read_site
from geofit.io.columns import SURVEY
from geofit.io.formats import read_any_table
from geofit.io.guess import guess_roles
from geofit.io.journal import Journal
from geofit.io.mapping import KINDS, ColumnMapping, load_mappings, save_mappings
from geofit.io.preview import preview_file
from geofit.io.source import Source


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("collar", "hole,x,y,z,depth\nB1,1,2,3,4\nB2,5,6,7,8\n"),
        ("collar", "BHID,XCOLLAR,YCOLLAR,ZCOLLAR\nB1,1,2,3\nB2,5,6,7\n"),
        ("survey", "BHID,AT,BRG,DIP\nB1,0,10,60\nB1,20,11,61\n"),
        ("intervals", "孔号,起始深度,终止深度,地层代号\nB1,0,5,Q\nB1,5,9,T2\n"),
        ("picks", "X,Y,Z,surface\n1,2,3,A\n4,5,6,A\n"),
        ("picks", "x,y,z\n1,2,3\n4,5,6\n"),
        ("traces", "horizon,x,y\nA,1,2\nA,4,5\n"),
        ("section", "horizon,distance,elevation\nA,1,2\nA,4,5\n"),
        ("section lines", "section,x,y\nC1,1,2\nC1,4,5\n"),
        ("adit path", "平硐编号,X,Y,Z\nPD1,1,2,3\nPD1,4,5,6\n"),
        ("adit contacts", "adit,chainage,horizon\nPD1,50,A\n"),
        ("orientations", "X,Y,Z,azimuth,dip,formation\n1,2,3,90,30,A\n4,5,6,91,31,A\n"),
        ("orientations", "X,Y,Z,strike,dip\n1,2,3,90,30\n"),
        ("boundary", "x;y\n0;0\n9;0\n9;9\n"),
        ("", "a,b,c\nu,v,w\n"),
        ("", "1,2,3,4\n5,6,7,8\n"),
    ],
)
def test_kinds(write, kind, text):
    (preview,) = preview_file(write(text))
    assert preview.kind == kind
    if kind:
        assert preview.confidence == max(preview.kinds.values())
        assert not preview.missing
        assert all(0 < guess.confidence <= 1 for guess in preview.roles)


def test_values_speak_against_a_name(write):
    source = Source(path=write("hole,depth,azimuth,dip\nB1,5,SE,200\nB2,6,NW,210\n"))
    guesses = guess_roles(read_any_table(source, Journal()), SURVEY, source)
    assert guesses["azimuth"].confidence < 0.3
    assert "not numbers" in str(guesses["azimuth"].reason)
    assert guesses["dip"].confidence < 0.5 < guesses["depth"].confidence
    assert "not between −90 and 90" in str(guesses["dip"].reason)
    assert preview_file(source)[0].kind == ""


def test_an_empty_column_gives_way(write):
    rows = "".join(f"B1,{i},{i + 1},,clay\n" for i in range(20))
    (preview,) = preview_file(write("hole,from,to,code,lithology\n" + rows))
    guess = next(guess for guess in preview.roles if guess.role == "code")
    assert (guess.column, guess.others) == ("lithology", ("code",))


def test_overruled_saved_and_used_again(write, tmp_path):
    path = write("E;N;H;H2;what\n1,5;2;3;30;A\n4;5;6;60;B\n", "camp_1.csv")
    (preview,) = preview_file(path)
    mapping = ColumnMapping(
        file="camp_*.csv", kind="picks", columns={"x": "E", "y": 2, "z": "H2", "horizon": "what"}, unit="ft"
    )
    save_mappings([preview.mapping, mapping], tmp_path / "m.toml", {(1, "z"): 'said by "hand"\n'})
    first, again = load_mappings(tmp_path / "m.toml")
    assert again == mapping
    assert first == preview.mapping
    assert again.suits("folder/CAMP_2.csv")
    assert not again.suits("other.csv")
    for name in ("camp_1.csv", "camp_2.csv"):
        picks = read_points(write(path.read_text(), name), mapping=again)
        np.testing.assert_allclose(picks.horizons["A"].xyz, [[1.5 * 0.3048, 2 * 0.3048, 30 * 0.3048]])
    (said,) = preview_file(path, [again])
    assert {guess.role: guess.stated for guess in said.roles}["z"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("version = 2\n", "version 2; this geofit reads up to 1"),
        ("[[table]]\nfile = 'a'\nkind = 'colar'\n", "Did you mean 'collar'"),
        ("[[table]]\nfile = 'a'\n", "no 'kind'"),
        ("[[table]]\nfile = 'a'\nkind = 'collar'\nseparator = ';'\n", "no key 'separator'"),
        ("[[table]]\nfile = 'a'\nkind = 'collar'\ncolumns = { x = 1.5 }\n", "a table of headers or numbers"),
        ("[[table\n", "not valid TOML"),
        ("[tabel]\n", "not 'tabel'"),
    ],
)
def test_broken_mappings(write, text, words):
    with pytest.raises(InputError, match=words):
        load_mappings(write(text, "m.toml"))


def test_site_file_reads_by_a_mapping(make_site, files):
    header, *rows = files["collar.csv"].splitlines()
    assert header == "hole,x,y,z,depth"
    odd = "\n".join(["name,u,v,w,reach", *rows])
    columns = "{ hole = 'name', x = 2, y = 'v', z = 4, depth = 5 }"
    mapping = f"[[table]]\nfile = 'collar.csv'\nkind = 'collar'\ncolumns = {columns}\n"
    expected = read_site(make_site()).horizons["T2-T1"].xyz
    path = make_site(collar=odd, **{"mapping.toml": mapping})
    site = path.read_text(encoding="utf-8").replace("[site]", "[site]\nmapping = 'mapping.toml'")
    path.write_text(site, encoding="utf-8")
    np.testing.assert_array_equal(read_site(path).horizons["T2-T1"].xyz, expected)


texts = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=12)


@given(
    file=texts,
    kind=st.sampled_from(KINDS),
    columns=st.dictionaries(texts, texts | st.integers(1, 99), max_size=4),
    table=texts,
    unit=st.none() | texts,
)
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_mappings_survive_their_file(tmp_path, file, kind, columns, table, unit):
    mapping = ColumnMapping(file=file, kind=kind, columns=columns, table=table, unit=unit)
    save_mappings([mapping], tmp_path / "m.toml")
    assert load_mappings(tmp_path / "m.toml") == (mapping,)
