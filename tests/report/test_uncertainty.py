"""The map of the standard deviation: no text covers another, however the suggested holes and the lines lie."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from geofit.data.prediction import PredictionResult, Suggestion, Uncertainty
from geofit.report.result import HorizonResult
from geofit.report.uncertainty import uncertainty_map


@pytest.mark.parametrize("width", [3.5, 6.5, 10.0])
@pytest.mark.parametrize("seed", range(6))
def test_no_number_of_a_suggested_hole_covers_a_label_or_a_cross(sample_site, sample_surfaces, seed, width):
    rng = np.random.default_rng(seed)
    x, y = np.linspace(0, 800, 60), np.linspace(0, 600, 50)
    a, b = rng.uniform(60, 110, 2)
    sd = 3 + 2 * np.sin(x / a) * np.cos(y[:, None] / b)
    # Holes lie where the deviation is greatest, amid close lines; two next to each other.
    rows, columns = np.unravel_index(np.argsort(sd, axis=None)[-40::8], sd.shape)
    holes = np.column_stack([x[columns], y[rows]])
    holes = np.concatenate([holes, holes[:1] + 25, rng.uniform((0, 0), (800, 600), (8, 2))])
    found = PredictionResult(
        (),
        Uncertainty(x, y, sd, 3.0, 1.0, 5.0, sd),
        tuple(Suggestion(e, n, 1000.0, 5.0, 1.0, 4.0) for e, n in holes.tolist()),
        (),
        (),
    )
    surface = next(iter(sample_surfaces.values()))
    points = surface.points.with_(xyz=surface.points.xyz - surface.points.xyz.mean(axis=0) + (400, 300, 1000))
    result = HorizonResult(surface.with_(points=points), sample_site, prediction=found)
    figure = Figure(figsize=(width, 0.8 * width))
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    uncertainty_map(axes, result)
    canvas.draw()
    numbers = [text for text in axes.texts if text.get_text() in {str(i) for i in range(1, len(holes) + 1)}]
    numbers = [text for text in numbers if text.get_weight() == "bold"]
    labels = [text for text in axes.texts if text not in numbers and text.get_text()]
    assert len(numbers) == len(holes)
    assert labels
    boxes = {id(text): text.get_window_extent(canvas.get_renderer()) for text in axes.texts}
    for one, other in [*combinations(numbers, 2), *((n, label) for n in numbers for label in labels)]:
        assert not boxes[id(one)].overlaps(boxes[id(other)]), (one.get_text(), other.get_text())
    half = figure.dpi / 72 * 3
    crosses = [Bbox([at - half, at + half]) for at in axes.transData.transform(holes)]
    for one in numbers:
        assert not any(boxes[id(one)].overlaps(cross) for cross in crosses)
        assert axes.bbox.contains(*boxes[id(one)].min)
        assert axes.bbox.contains(*boxes[id(one)].max)
