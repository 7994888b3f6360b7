"""CAD files of strangers are read in a child: whatever damage does to it ends in an InputError."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from surfaces import horizon, nine

from geofit.cad import foreign
from geofit.cad.foreign import READERS, child, read_in_child
from geofit.cad.handover import load_result, save_result
from geofit.cad.iges_brep import brep_surfaces
from geofit.cad.step import read_step, write_step
from geofit.data.errors import InputError
from geofit.io import read_surfaces, write_surface
from geofit.surfaces.trimmed import TrimmedSurface

HOSTILE = Path(os.environ.get("GEOFIT_DATA", Path(__file__).parents[3] / "shared" / "data")) / "hostile"


OUTLINE = [[100, 80], [500, 20], [900, 100], [950, 600], [80, 650]]


@pytest.fixture(scope="module")
def step(tmp_path_factory):
    path = tmp_path_factory.mktemp("foreign") / "a.step"
    write_step({"a": horizon(nine()[1], name="a", outline=OUTLINE)}, path)
    return path


def same(one, two):
    assert one.keys() == two.keys()
    for a, b in zip(one.values(), two.values(), strict=True):
        assert type(a) is type(b)
        np.testing.assert_array_equal(a.origin, b.origin)
        np.testing.assert_array_equal(a.outline, b.outline)
        for p, q in zip(a.patches, b.patches, strict=True):
            assert (p.name, p.degree) == (q.name, q.degree)
            np.testing.assert_array_equal(p.control, q.control)
            np.testing.assert_array_equal(p.knots_u, q.knots_u)
            np.testing.assert_array_equal(p.knots_v, q.knots_v)
            np.testing.assert_array_equal(p.weights, q.weights)
        if any(a.loops):
            for loops, others in zip(a.loops, b.loops, strict=True):
                for loop, other in zip(loops, others, strict=True):
                    np.testing.assert_array_equal(loop, other)


@pytest.mark.parametrize("ending", ["step", "igs", "brep"])
def test_a_child_reads_what_this_process_reads(step, tmp_path, ending, request):
    path = step
    if ending != "step":
        path = tmp_path / f"a.{ending}"
        write_surface({"a": horizon(nine()[1], name="a", outline=OUTLINE)}, path)
    child = read_surfaces(path)
    request.getfixturevalue("read_here")
    same(child, read_surfaces(path))


def test_what_is_written_is_loaded_with_weights_and_loops(tmp_path):
    from dataclasses import replace

    patches = nine()[1]
    weighed = replace(patches[0], weights=np.full(patches[0].control.shape[:2], 2.0))
    loops = ((np.arange(6.0).reshape(3, 2),), *((),) * (len(patches) - 1))
    surface = horizon([weighed, *patches[1:]], name="坝")
    cut = TrimmedSurface(surface.patches, surface.origin, "坝", trim_loops=loops)
    save_result(tmp_path / "r.npz", {"坝": cut})
    same(load_result(tmp_path / "r.npz", Path("x")), {"坝": cut})


@pytest.mark.skipif(not HOSTILE.is_dir(), reason="the hostile files are not here (GEOFIT_DATA)")
@pytest.mark.parametrize(
    "name", ["1003_s.step", "2802_s.igs", "666_s.igs", "4075_s.brep", "4612_s.brep", "4651_s.brep"]
)
def test_a_file_that_ends_or_stops_opencascade_is_refused(name):
    with pytest.raises(InputError, match=r"damaged|takes longer|needs too much") as refused:
        read_surfaces(HOSTILE / name)
    assert "export the surface as STEP again" in str(refused.value)


def test_a_reader_that_never_returns_is_ended(step, monkeypatch):
    monkeypatch.setattr(foreign, "SECONDS", 0.2)
    monkeypatch.setattr(foreign, "SECONDS_MB", 0.0)
    before = time.monotonic()
    with pytest.raises(InputError, match="takes longer"):
        read_in_child(step, "step")
    assert time.monotonic() - before < 20


#: A child that counts until it is ended, and the process that waits for it.
COUNTING = """
import time
from pathlib import Path
from geofit.cad.foreign import _end_with_caller
_end_with_caller()
for k in range(100_000):
    Path({file!r}).write_text("." * k)
    time.sleep(0.01)
"""
WAITING = "import sys\nfrom geofit.cad.foreign import _run\n_run([sys.executable, '-c', {code!r}], 600)"


def test_a_child_ends_with_the_process_that_waits_for_it(tmp_path):
    file = tmp_path / "count"
    waiting = subprocess.Popen([sys.executable, "-c", WAITING.format(code=COUNTING.format(file=str(file)))])
    until = time.monotonic() + 60
    while not (file.exists() and file.stat().st_size) and time.monotonic() < until:
        time.sleep(0.05)
    waiting.kill()
    waiting.wait()
    time.sleep(0.5)
    counted = file.stat().st_size
    time.sleep(1.0)
    assert file.stat().st_size == counted > 0


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits of memory are those of Linux")
def test_a_reader_that_needs_too_much_memory_is_ended(step, monkeypatch):
    monkeypatch.setattr(foreign, "MEMORY", 30_000_000)
    monkeypatch.setattr(foreign, "MEMORY_BYTE", 0)
    with pytest.raises(InputError, match=r"damaged|memory"):
        read_in_child(step, "step")


@pytest.mark.parametrize("seed", range(4))
def test_damaged_bytes_give_surfaces_or_an_input_error(step, tmp_path, seed):
    rng = random.Random(seed)
    data = bytearray(step.read_bytes())
    for _ in range(20):
        data[rng.randrange(len(data))] = rng.randrange(256)
    (tmp_path / "b.step").write_bytes(data[: rng.randrange(len(data) // 2, len(data))])
    with suppress(InputError):
        assert read_step(tmp_path / "b.step")


def test_coordinates_that_are_no_numbers_are_refused(tmp_path):
    patch = nine()[1][0]
    control = patch.control.copy()
    control[0, 0, 0] = np.nan
    from dataclasses import replace

    save_result(tmp_path / "r.npz", {"a": horizon([replace(patch, control=control)])})
    with pytest.raises(InputError) as refused:
        load_result(tmp_path / "r.npz", Path("x"))
    assert refused.value.code == "cad.not-finite"


@pytest.mark.parametrize("name", ["none.step", "with\0nul.step"])
def test_a_file_that_is_not_there(tmp_path, name):
    with pytest.raises(InputError, match="no such file"):
        read_step(tmp_path / name)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes with a name are for Linux and macOS")
def test_a_pipe_is_no_file(tmp_path):
    os.mkfifo(tmp_path / "p.step")
    with pytest.raises(InputError, match="no such file"):
        read_step(tmp_path / "p.step")


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="names are bytes on Linux only")
def test_a_name_in_gbk_is_read(step, tmp_path):
    path = tmp_path / os.fsdecode("层面.step".encode("gbk"))
    path.write_bytes(step.read_bytes())
    same(read_step(path), read_step(step))


def test_the_folder_that_a_program_starts_in_is_not_imported(step, tmp_path):
    (tmp_path / "json.py").write_text("raise SystemExit(7)\n")
    code = f"from geofit.cad.step import read_step; print(list(read_step({str(step)!r})))"
    done = subprocess.run([sys.executable, "-P", "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stdout.strip() == "['a']", done.stderr


def test_every_reader_is_there():
    import importlib

    for module, function in READERS.values():
        assert callable(getattr(importlib.import_module(module), function))
    assert READERS["brep"][1] == brep_surfaces.__name__
    assert callable(child)
