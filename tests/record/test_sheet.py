"""A map on a sheet: whatever its shape and however much is to be explained, nothing covers it or is cut."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.patches import Patch

from vedette.record.canvas import picture
from vedette.record.sheet import Sheet


@pytest.mark.parametrize("shape", [(40, 60), (10, 400), (400, 10)])
@pytest.mark.parametrize("labels", [0, 3, 64])
@pytest.mark.parametrize("title", ["hall", f"hall, maps joined after {', '.join(['100 s'] * 40)}"])
def test_title_scale_and_key_are_on_the_sheet_and_beside_the_map(
    shape: tuple[int, int], labels: int, title: str
) -> None:
    rows, cols = shape
    with picture():
        names = [f"robot-{number}, not joined" for number in range(labels)]
        sheet = Sheet.make(
            np.zeros((rows, cols, 3), np.uint8), (0.0, cols * 0.1, 0.0, rows * 0.1), title, names
        )
        sheet.explain([Patch(fc="white")] * labels)
        canvas = FigureCanvasAgg(sheet.figure)
        canvas.draw()
    renderer = canvas.get_renderer()
    page, of_map = sheet.figure.bbox, sheet.axes.get_window_extent(renderer)
    assert len(sheet.figure.legends) == labels
    for legend in sheet.figure.legends:
        box = legend.get_window_extent(renderer)
        assert page.x0 <= box.x0 < box.x1 <= page.x1
        assert page.y0 <= box.y0 < box.y1 <= of_map.y0
    scale = sheet.figure.axes[1].get_tightbbox(renderer)
    assert scale is not None
    assert scale.y1 <= of_map.y0
    if labels:
        assert scale.y0 >= max(legend.get_window_extent(renderer).y1 for legend in sheet.figure.legends)
    said = sheet.axes.get_title(loc="left")
    assert title.startswith(said.split("…")[0])
    box = sheet.axes._left_title.get_window_extent(renderer)  # type: ignore[attr-defined]
    assert page.x0 <= box.x0 < box.x1 <= page.x1
    assert of_map.y1 <= box.y0 < box.y1 <= page.y1
