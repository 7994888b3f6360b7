"""The field and the block model of a body, read back by another reader."""

from __future__ import annotations

import json
import zlib
from pathlib import Path

import numpy as np
import pytest

from bodies.planted import ORIGIN, SIZE, drilled, ellipsoid
from geofit.bodies.blocks import block_model
from geofit.bodies.body import BodyFit
from geofit.bodies.data import BodyData
from geofit.bodies.fit import fit_body
from geofit.bodies.posterior import ON_SURFACE, BodyPosterior
from geofit.bodies.settings import BodySettings
from geofit.data.errors import InputError, SettingsError
from geofit.io.export.block_model import write_block_model
from geofit.io.export.ifc import write_ifc
from geofit.io.export.vti import write_vti


def test_vti_as_vtk_reads_it(ring: BodyFit, tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    path = tmp_path / "ring.vti"
    write_vti(ring, path, 4.0)
    assert [file.name for file in tmp_path.iterdir()] == ["ring.vti"]
    image = pyvista.read(path)
    points = np.asarray(image.points)
    np.testing.assert_allclose(image.point_data["field"], ring.value(points), atol=1e-6)
    some = np.arange(0, len(points), 37)
    np.testing.assert_allclose(
        image.point_data["probability"][some], BodyPosterior(ring).probability(points[some]), atol=1e-6
    )
    surface = image.contour([0.0], scalars="field")
    assert surface.n_open_edges == 0
    assert surface.volume == pytest.approx(ring.triangulate().volume, rel=0.01)
    again = tmp_path / "again.vti"
    write_vti(ring, again, 4.0)
    assert again.read_bytes() == path.read_bytes()


def test_block_model(ring: BodyFit, tmp_path: Path) -> None:
    write_block_model(ring, tmp_path / "blocks.csv", 5.0)
    table = np.genfromtxt(tmp_path / "blocks.csv", delimiter=",", names=True)
    model = block_model(ring, 5.0)
    assert len(table) == len(model.centres) == np.prod(model.shape)
    centres = np.column_stack([table["x"], table["y"], table["z"]])
    np.testing.assert_allclose(centres % 5.0, 0, atol=1e-6)
    np.testing.assert_allclose(table["field"], ring.value(centres), rtol=1e-5, atol=1e-5)
    expected = table["probability"].sum() * 125
    assert expected == pytest.approx(ring.triangulate().volume, rel=0.05)
    assert ((table["probability"] > ON_SURFACE) == (table["field"] < 0)).mean() > 0.999


def test_probability_is_calibrated() -> None:
    """Of blocks with a chance of p, about p lie in the true body."""
    chance, true = [], []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        truth = ellipsoid(tuple(rng.uniform(0.35, 0.65, 3)))[0]
        model = block_model(fit_body(drilled(truth, seed)))
        doubt = (model.probability > 0.02) & (model.probability < 0.98)
        chance.append(model.probability[doubt])
        true.append(truth((model.centres[doubt] - ORIGIN) / SIZE) < 0)
    p, inside = np.concatenate(chance), np.concatenate(true)
    for low, high in ((0.02, 0.3), (0.3, 0.7), (0.7, 0.98)):
        own = (p > low) & (p < high)
        # An ellipsoid is smoother than rock: what is said of it is up to 12 points too cautious. Bodies of all kinds
        # are in test_spread.py.
        assert abs(p[own].mean() - inside[own].mean()) < 0.15


def test_blocks_that_are_too_small(ring: BodyFit) -> None:
    with pytest.raises(SettingsError, match="at most"):
        block_model(ring, 0.01)


def test_block_model_as_omf(ring: BodyFit, tmp_path: Path) -> None:
    path = tmp_path / "blocks.omf"
    write_block_model(ring, path, 5.0)
    raw, model = path.read_bytes(), block_model(ring, 5.0)
    start = int.from_bytes(raw[52:60], "little")
    parts = json.loads(raw[start:])
    (element,) = (part for part in parts.values() if part["__class__"] == "VolumeElement")
    grid = parts[element["geometry"]]
    assert grid["__class__"] == "VolumeGridGeometry"
    assert tuple(len(grid[f"tensor_{axis}"]) for axis in "uvw") == model.shape
    np.testing.assert_allclose(grid["origin"], model.centres[0] - 2.5)
    for key, values in zip(element["data"], (model.value, model.probability), strict=True):
        place = parts[parts[key]["array"]]["array"]
        stored = np.frombuffer(zlib.decompress(raw[place["start"] : place["start"] + place["length"]]), "<f8")
        np.testing.assert_array_equal(stored, values)


def test_block_model_as_geoh5(ring: BodyFit, tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "blocks.geoh5"
    write_block_model(ring, path, 5.0)
    model = block_model(ring, 5.0)
    with h5py.File(path) as file:
        (item,) = file["GEOSCIENCE/Objects"].values()
        edges = [item[f"{axis} cell delimiters"][:] for axis in "UVZ"]
        start = np.array(item.attrs["Origin"].tolist())
        # The order of geoh5py's centroids: np.meshgrid's own.
        middles = [(e[1:] + e[:-1]) / 2 for e in edges]
        centres = np.stack(np.meshgrid(*middles), axis=-1).reshape(-1, 3) + start
        stored = {data.attrs["Name"]: data["Data"][:] for data in item["Data"].values()}
    np.testing.assert_allclose(stored["field"], ring.value(centres), atol=1e-9)
    assert sorted(stored) == ["field", "probability"]
    assert len(centres) == len(model.centres)


def test_block_model_of_another_ending(ring: BodyFit, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\.csv, \.omf or \.geoh5"):
        write_block_model(ring, tmp_path / "blocks.xyz", 5.0)


def test_bodies_in_ifc(ring: BodyFit, two: BodyFit, tmp_path: Path) -> None:
    ifcopenshell = pytest.importorskip("ifcopenshell")
    path = tmp_path / "bodies.ifc"
    write_ifc({}, path, bodies={"ring": ring, "caves": two}, voids=["caves"])
    file = ifcopenshell.open(path)
    strata = {stratum.Name: stratum for stratum in file.by_type("IfcGeotechnicalStratum")}
    assert {name: stratum.PredefinedType for name, stratum in strata.items()} == {"ring": "SOLID", "caves": "VOID"}
    for name, body in (("ring", ring), ("caves", two)):
        (shape,) = strata[name].Representation.Representations
        (faces,) = shape.Items
        assert faces.Closed
        place = strata[name].ObjectPlacement.RelativePlacement.Location.Coordinates
        corners = np.array(faces.Coordinates.CoordList)[np.array(faces.CoordIndex) - 1]
        volume = np.linalg.det(corners).sum() / 6
        assert volume == pytest.approx(body.overview.volume, rel=1e-6)
        np.testing.assert_allclose(place, body.origin)
    again = tmp_path / "again.ifc"
    write_ifc({}, again, bodies={"ring": ring, "caves": two}, voids=["caves"])
    assert again.read_bytes() == path.read_bytes()
    with pytest.raises(InputError, match="not among the bodies"):
        write_ifc({}, path, bodies={"ring": ring}, voids=["cave"])


def test_no_chance_is_stated_beyond_the_reach_of_the_data(tmp_path: Path) -> None:
    """It was 0 there, although of real samples in such ground, in holes that were left out, 15 % lie inside."""
    unit = np.random.default_rng(1).normal(size=(60, 3))
    unit /= np.linalg.norm(unit, axis=1)[:, None]
    middles = np.array([[0.0, 0.0, 0.0], [160.0, 0.0, 0.0]])
    shells = [(middles[:, None] + radius * unit).reshape(-1, 3) for radius in (10.0, 15.0)]
    body = fit_body(BodyData(shells[0], middles, shells[1]), BodySettings(reach=40.0))
    model = block_model(body, 8.0)
    data = np.concatenate([*shells, middles])
    far = np.linalg.norm(model.centres[:, None] - data, axis=2).min(axis=1) > 40.0
    assert far.sum() > 50
    assert (np.isnan(model.probability) == far).all()
    known = model.probability[~far]
    assert ((known >= 0) & (known <= 1)).all()
    assert known.max() > 0.9
    write_block_model(body, tmp_path / "blocks.csv", 8.0)
    cells = [row.split(",")[5] for row in (tmp_path / "blocks.csv").read_text(encoding="utf-8").splitlines()[1:]]
    assert [cell == "" for cell in cells] == far.tolist()
