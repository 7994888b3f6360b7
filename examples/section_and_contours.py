"""Draw a section and a contour plan.

``cut_section`` cuts a surface with a vertical curtain along a line that may bend; ``contours`` follows lines of equal
elevation. Their vertices lie on the surface, also where it is overturned.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt

import geofit

out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
site = geofit.io.read_site(Path(__file__).parents[1] / "sample_data" / "site.toml")
fits = geofit.fit_site(site, ["T3-T2", "T2-T1", "M1"]).surfaces
east, north = site.boundary.mean(axis=0)
line = [[east - 500, north - 100], [east, north + 50], [east + 450, north - 50]]

figure, (plan, section) = plt.subplots(2, 1, figsize=(8, 9.5), layout="constrained", height_ratios=(3, 2))
for contour in geofit.contours(fits["T2-T1"], interval=10.0):
    plan.plot(
        *(contour.line[:, :2] - [east, north]).T, color="#b08a20", linewidth=1.6 if contour.elevation % 50 == 0 else 0.7
    )
plan.plot(*zip(*((x - east, y - north) for x, y in line), strict=True), color="black", label="section")
plan.set(title="T2-T1, contours every 10 m", aspect="equal", xlabel="x - centre, m", ylabel="y - centre, m")
plan.legend()
for (name, fit), colour in zip(fits.items(), ("#5a91cf", "#b08a20", "#9a4aa0"), strict=True):
    for number, piece in enumerate(geofit.cut_section(fit, line)):
        section.plot(piece.distance, piece.xyz[:, 2], color=colour, label=name if number == 0 else None)
section.set(title="section", aspect="equal", xlabel="distance along the section, m", ylabel="elevation, m")
section.legend()
out.mkdir(parents=True, exist_ok=True)
figure.savefig(out / "section_and_contours.png", dpi=120)
geofit.write_surface(fits, out / "contours.dxf", interval=10.0)
