"""The Chinese catalogue: nothing that the report or the core says is missing, and no placeholder is lost."""

from __future__ import annotations

import csv
import errno
import os
import pickle
from dataclasses import replace

import pytest
from chinese import english_left

from geofit.data.errors import InputError, SettingsError
from geofit.data.languages import EN, ZH, language, sentence, translate
from geofit.data.messages import Untranslated, message


def test_a_sentence_of_the_core_is_told_with_its_values():
    text = message("checks.places-folded-count", "{count} of {total} places folded or degenerate", count=3, total=40)
    assert translate(text, EN) == "3 of 40 places folded or degenerate"
    assert translate(text, ZH) == "40 处中有 3 处折叠或退化"
    inner = message(
        "fitting.core-given-up",
        "{reason}, but all points are approximated: {error}",
        reason=message("fitting.dense-points-fill-area", "the dense points fill the area"),
        error="x",
    )
    assert translate(inner, ZH) == "密集点布满全区，但全部点采用逼近：x"


def test_what_the_readers_list_is_told_in_chinese(tmp_path):
    from geofit.io.picks import read_points

    (tmp_path / "p.csv").write_text(
        "x,y,z,surface,hole\n1,2,3,T1,B1\n1,2,4,T1,B2\n5,6,abc,T1,B3\n7,8,,T1,B4\n", encoding="utf-8"
    )
    found = {issue.row: issue for issue in read_points(tmp_path / "p.csv").issues if issue.severity != "note"}
    assert str(found[4].reason) == "The z is not a finite number"
    assert translate(found[4].reason, ZH) == "z不是有限数"
    assert translate(found[5].reason, ZH) + translate(found[5].remedy, ZH) == "z为空请补全该单元格。"
    assert translate(found[3].reason, ZH) == "层面 T1：同一位置有两个高程，与 点 B1，p.csv 第 2 行 相差 +1.000 m"


def test_words_alone_are_told_and_names_are_left():
    assert (translate("borehole", ZH), translate("ZK101", ZH)) == ("钻孔", "ZK101")
    assert sentence("largest angle at a seam", EN) == "Largest angle at a seam."
    assert sentence(message("checks.largest-seam-angle", "largest angle at a seam"), ZH) == "拼接缝处的最大夹角。"
    assert sentence("Not told", ZH) == "Not told."


def test_an_unknown_language_names_the_known_ones():
    assert language("zh") is ZH
    with pytest.raises(SettingsError, match="en or zh"):
        language("fr")


def test_english_that_is_left_is_found():
    assert english_left(message("data.reason-sentence", "{reason}.", reason="Nobody said this")) == ["Nobody said this"]


def test_an_error_is_told_as_a_whole():
    reason = message(
        "io.project-not-written", "The project cannot be written: {error}", error=os.strerror(errno.EACCES)
    )
    error = InputError(
        reason,
        message("data.make-or-name-folder", "Make the folder, or name another."),
        file="site.toml",
        row=3,
        column="base",
        value="map",
    )
    assert str(error) == (
        "site.toml, row 3, column 'base', value 'map': The project cannot be written: Permission denied. "
        "Make the folder, or name another."
    )
    told = "site.toml，第 3 行，列“base”，值“map”：工程不能写出：没有访问权限。请建立该文件夹，或另行指定。"
    assert translate(error.message, ZH) == translate(pickle.loads(pickle.dumps(error)).message, ZH) == told


def test_a_reason_that_ends_with_a_full_stop_gets_no_second_one():
    inner = message(
        "fitting.patch-unknown", "There is no patch '{patch}'. The patches are: {names}.", patch="x", names="core"
    )
    error = InputError(inner, message("data.check-path", "Check the path."))
    assert str(error).count("..") == 0
    assert translate(error.message, ZH).endswith("核心区。请检查路径。")
    assert str(InputError(inner)) == str(inner)


def test_columns_keys_and_names_stay_as_they_are():
    assert translate(Untranslated("north"), ZH) == "north" != translate("north", ZH)
    assert translate((Untranslated("core"), message("data.place-row", "row {row}", row=2)), ZH) == "core，第 2 行"
    assert translate((), ZH) == "()"


@pytest.mark.parametrize(
    "code",
    ["EACCES", "EPERM", "ENOENT", "ENOSPC", "EROFS", "EISDIR", "ENOTDIR", "EEXIST", "EBUSY", "EIO", "ENAMETOOLONG"],
)
def test_what_the_system_says_of_files_is_told(code):
    if os.name != "posix":
        pytest.skip("the texts are those of POSIX systems")
    assert translate(os.strerror(getattr(errno, code)), ZH) != os.strerror(getattr(errno, code))


def test_what_is_wrong_in_a_site_file_is_told_with_its_line(tmp_path):
    from geofit.io import read_site

    (tmp_path / "site.toml").write_text("[site]\nname 'x'\n", encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_site(tmp_path / "site.toml")
    assert translate(caught.value.message, ZH) == (
        "site.toml，第 2 行：文件不是 TOML：键之后应为“=”。请见 docs/site_file.md。"
    )


def test_tables_of_a_chinese_report_have_chinese_reasons(tmp_path):
    from results import horizon

    from geofit.data.site import ImportIssue
    from geofit.report.tables import write_issues, write_residuals

    issue = ImportIssue(
        "p.csv",
        4,
        "z",
        "abc",
        "error",
        message("io.cell-not-a-number", "The {role} is not a finite number", role="z"),
        message("io.complete-the-cell", "Complete the cell."),
    )
    write_issues([issue], tmp_path / "i.csv", ZH)
    with (tmp_path / "i.csv").open(encoding="utf-8-sig", newline="") as stream:
        (row,) = csv.DictReader(stream)
    assert (row["severity"], row["column"], row["reason"], row["remedy"]) == (
        "error", "z", "z不是有限数", "请补全该单元格。",
    )  # fmt: skip
    result = horizon()
    (conflict,) = result.accuracy.conflicts
    text = message(
        "fitting.conflict-repeated",
        "{dropped} repeats {kept}",
        dropped=result.surface.points.describe(conflict.dropped),
        kept="x",
    )
    accuracy = replace(result.accuracy, conflicts=(replace(conflict, text=text),))
    write_residuals(replace(result, surface=result.surface.with_(accuracy=accuracy)), tmp_path / "r.csv", ZH)
    with (tmp_path / "r.csv").open(encoding="utf-8-sig", newline="") as stream:
        (dropped,) = [row for row in csv.DictReader(stream) if row["used"] == "no"]
    assert dropped["reason"].endswith("与 x 重复")
    assert dropped["reason"].startswith(translate(dropped["kind"], ZH))
