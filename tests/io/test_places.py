"""Points at one location: of a horizon over the map one of two elevations is wrong, of an upright fault neither is."""

from __future__ import annotations

import pytest

from geofit.io.site_file import read_site


@pytest.mark.parametrize(("frame", "warned"), [("", 6), ('frame = "map"', 6), ('frame = "best-plane"', 0)])
def test_an_upright_fault_has_several_elevations_at_one_location(write, frame, warned):
    rows = [f"F1,{500_000 + 100 * k},{3_100_000},{z}" for k in range(3) for z in (100, 200, 300)]
    write("horizon,x,y,z\n" + "\n".join(rows) + "\n", "picks.csv")
    site = read_site(write(f'[picks]\nfile = "picks.csv"\n[[horizon]]\nname = "F1"\n{frame}\n', "site.toml"))
    assert [issue.reason.code for issue in site.issues].count("io.horizon-elevations-differ") == warned
    assert len(site.horizons["F1"]) == 9
