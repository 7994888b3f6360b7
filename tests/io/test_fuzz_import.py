"""A few hundred seeded damaged files; the 10,000 are in benchmarks/fuzz_import.py."""

from __future__ import annotations

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path


def test_damaged_files_end_in_rows_or_a_geofit_error(tmp_path):
    spec = spec_from_file_location("fuzz_import", Path(__file__).parents[2] / "benchmarks" / "fuzz_import.py")
    fuzz = module_from_spec(spec)
    spec.loader.exec_module(fuzz)
    outcomes, failures = fuzz.run(300, 11, tmp_path)
    assert not failures, "\n".join(failures)
    assert outcomes["read"] > 100
    assert outcomes["geofit error"] > 50
    assert outcomes["rows listed"] > 100
