"""Attributes, author and certificate of a STEP file: what was written is what OpenCASCADE and a person read."""

from __future__ import annotations

import hashlib
from dataclasses import replace

import numpy as np
import pytest

from geofit import FitSettings, PointSet, fit_horizon
from geofit.cad.imported import surface_of
from geofit.cad.step import read_shapes, read_step, write_step
from geofit.cad.step_attributes import KEYS, attributes_of, stated_frame, stated_outline, with_attributes
from geofit.data.languages import EN
from geofit.fitting.judge import judge
from geofit.project.step_files import Signed, write_step_files
from geofit.report.certificate import certificate
from geofit.report.document import ReportTable

ORIGIN = np.array([500_000.0, 3_100_000.0, 1500.0])


def surface(name, seed, epsilon=0.5):
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, 300, (60, 2))
    z = 5 * np.sin(xy[:, 0] / 60) + rng.normal(0, 0.05, 60)
    points = PointSet(np.column_stack([xy, z]) + ORIGIN)
    return fit_horizon(points, FitSettings(epsilon=epsilon), name=name)


@pytest.fixture(scope="module")
def surfaces():
    return {"T2": surface("T2", 1), "风化下限 'a'": surface("风化下限 'a'", 2, 0.25)}


def test_only_a_fit_that_ends_at_an_outline_goes_on_beneath_its_loops(tmp_path):
    """A foreign face that is trimmed stays so when it is written again: beneath its loops nothing is known."""
    rng = np.random.default_rng(3)
    xy = rng.uniform(0, 400, (80, 2))
    points = PointSet(np.column_stack([xy, 5 * np.sin(xy[:, 0] / 60)]) + ORIGIN)
    corners = [[0, 0], [400, 0], [400, 400], [260, 400], [200, 150], [140, 400], [0, 400]]
    fit = fit_horizon(points, boundary=np.array(corners) + ORIGIN[:2], name="T")
    write_step({"T": fit}, tmp_path / "fit.step")
    (shape,) = read_shapes(tmp_path / "fit.step")
    assert shape.attributes["beyond_loops"] == "continued"
    (back,) = read_step(tmp_path / "fit.step").values()
    assert back.outline is not None
    assert not any(back.loops)
    judged = judge(back, points)
    assert judged.accuracy.sigma == pytest.approx(fit.accuracy.sigma, rel=1e-5, abs=1e-8)

    foreign = surface_of(replace(shape, attributes={}))
    assert any(foreign.loops)
    cut = judge(foreign, points)
    assert cut.accuracy.sigma > 100 * judged.accuracy.sigma
    (found,) = write_step({"T": cut}, tmp_path / "again.step").values()
    assert all(check.passed for check in found.checks if check.name == "read-back attributes")
    (again,) = read_shapes(tmp_path / "again.step")
    assert "beyond_loops" not in again.attributes
    (back,) = read_step(tmp_path / "again.step").values()
    assert judge(back, points).accuracy.sigma == pytest.approx(cut.accuracy.sigma, rel=1e-4)


def test_frame_and_outline_of_a_fold_are_read_as_written_or_not_at_all():
    outline = np.array([[0.25, 0.0], [40.0, 0.0], [40.0, 30.0]]) + ORIGIN[:2]
    text = " ".join(f"{x:.7f},{y:.7f}" for x, y in outline)
    assert np.array_equal(stated_outline({"outline": text}), outline)
    for wrong in ("", "1,2 3", "1,2 3,4", "nan,0 1,0 1,1", "0,0 1,0 2,0", "0,0 1,1 1,0 0,1", "a,b"):
        assert stated_outline({"outline": wrong}) is None
    assert stated_outline({}) is None
    assert [stated_frame({"frame": word}) for word in ("sections", "map", "x")] == ["sections", "", ""]


@pytest.mark.parametrize("unit", ["m", "mm"])
def test_each_product_has_its_own_figures(surfaces, tmp_path, unit):
    found = write_step(surfaces, tmp_path / "dam.step", unit=unit)
    shapes = read_shapes(tmp_path / "dam.step")
    assert [shape.name for shape in shapes] == list(surfaces)
    for shape, (name, one) in zip(shapes, surfaces.items(), strict=True):
        assert [*shape.attributes, "frame", "beyond_loops", "outline"] == list(KEYS)
        assert float(shape.attributes["sigma_m"]) == pytest.approx(one.accuracy.sigma, rel=1e-5)
        assert float(shape.attributes["epsilon_m"]) == one.settings.epsilon
        assert float(shape.attributes["largest_residual_m"]) == pytest.approx(one.accuracy.max_abs, rel=1e-5)
        assert int(shape.attributes["points"]) == len(one.points)
        # Who has the points can make the hash anew.
        assert shape.attributes["data_sha256"] == hashlib.sha256(one.points.xyz.astype("<f8").tobytes()).hexdigest()
        check = next(check for check in found[name].checks if check.name == "read-back attributes")
        assert check.passed


def test_a_file_whose_attributes_were_changed_is_found_out(surfaces, tmp_path):
    from geofit.cad.imported import surface_of
    from geofit.cad.read_back import read_back
    from geofit.cad.sewing import shell

    one = {"T2": surfaces["T2"]}
    path = tmp_path / "dam.step"
    write_step(one, path)
    sigma = attributes_of(one["T2"])["sigma_m"]
    text = path.read_text("ascii")
    assert text.count(f"'sigma_m','{sigma}'") == 1
    path.write_text(text.replace(f"'sigma_m','{sigma}'", "'sigma_m','0.0001'"), "ascii")
    (shape,) = read_shapes(path)
    back = read_back(one["T2"], shape, surface_of(shape, whole=True), shell(one["T2"]), path)
    check = next(check for check in back.checks if check.name == "read-back attributes")
    assert check.passed is False
    assert check.value == 1.0


def test_a_sigma_that_the_surface_does_not_have_is_found_out(surfaces, tmp_path):
    fit = surfaces["T2"]
    wrong = fit.with_(accuracy=replace(fit.accuracy, sigma=2 * fit.accuracy.sigma))
    for one, passed in ((fit, True), (wrong, False)):
        back = write_step({"T2": one}, tmp_path / "dam.step")["T2"]
        (check,) = [check for check in back.checks if check.name == "read-back attributes"]
        assert check.passed is passed
        assert (check.text.code == "cad.sigma-not-as-stated") is not passed


def test_author_and_organisation_are_in_the_head_and_the_bytes_stay_the_same(surfaces, tmp_path):
    for name in ("a", "b"):
        write_step(surfaces, tmp_path / f"{name}.step", author="M. O'Neil", organisation="长江设计院")
    text = (tmp_path / "a.step").read_text("ascii")
    head = text.split("ENDSEC;")[0]
    assert "M. O''Neil" in head
    assert "\\X2\\" + "长江设计院".encode("utf-16-be").hex().upper() + "\\X0\\" in head.replace("\n", "")
    assert (tmp_path / "a.step").read_bytes() == (tmp_path / "b.step").read_bytes()
    assert [shape.name for shape in read_shapes(tmp_path / "a.step")] == list(surfaces)


def test_quotes_in_values_cannot_break_the_file(surfaces, tmp_path):
    write_step({"T2": surfaces["T2"]}, tmp_path / "a.step")
    text = with_attributes((tmp_path / "a.step").read_text("ascii"), [{"sigma_m": "0.1', #1); '"}])
    (tmp_path / "b.step").write_text(text, "ascii")
    assert [shape.name for shape in read_shapes(tmp_path / "b.step")] == ["T2"]


def test_the_certificate_is_one_page_with_the_figures_of_the_file(surfaces, tmp_path):
    pdfium = pytest.importorskip("pypdfium2", reason="PDFium reads the PDF back; it comes with the extra 'test'")
    signed = Signed("M. Weber", "Dam Office", "en")
    for separate in (False, True):
        files = write_step_files(surfaces, tmp_path / "dam.step", "m", separate, signed, progress=lambda *_: True)
        for file in files:
            assert file.certificate == file.path.with_name(f"{file.path.stem}_certificate.pdf")
            pdf = pdfium.PdfDocument(file.certificate)
            try:
                assert len(pdf) == 1
                text = pdf[0].get_textpage().get_text_range()
            finally:
                pdf.close()
            digest = hashlib.sha256(file.path.read_bytes()).hexdigest()
            for word in (digest[:32], digest[32:], file.path.name, "M. Weber", "Dam Office", "PASS"):
                assert word in text, word


def test_many_horizons_stay_on_one_page_and_a_failed_one_is_named(surfaces, tmp_path):
    found = write_step({"T2": surfaces["T2"]}, tmp_path / "dam.step")["T2"]
    bad = replace(found, checks=(replace(found.checks[0], passed=False), *found.checks[1:]))
    every = {f"T{k}": bad if k == 3 else found for k in range(20)}
    page = certificate(tmp_path / "dam.step", every, dict.fromkeys(every, 0.5), EN)
    (chapter,) = page.chapters
    assert chapter.verdict.passed is False
    tables = [block for block in chapter.blocks if isinstance(block, ReportTable)]
    assert len(tables[0].rows) == 13
    assert [row[0] for row in tables[1].rows] == ["T3"]
