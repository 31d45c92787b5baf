"""What the probe reads of the particles in a rectangle. No web server, no engine."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from app.page.stage.probe import Probe
from tests.drawn import Sheet


def test_mean_and_worst_are_of_the_particles_in_the_rectangle_alone():
    """Drawn from its lower right to its upper left; one of three particles within has no estimate."""
    acts = []
    client = SimpleNamespace(scene=SimpleNamespace(on_rect_select=lambda: acts.append))
    camera = SimpleNamespace(on_stage=lambda place: place)
    x = np.array([0.1, 0.2, 0.3, 0.9])
    stage = SimpleNamespace(region=lambda low, high, arrays: (x >= low[0]) & (x <= high[0]))
    probe = Probe(client, Sheet(), camera)
    estimated, true = np.array([1e-3, np.nan, 5e-3, 1.0]), np.array([2e-3, 3e-3, 10e-3, 1.0])
    probe.look(stage, None, estimated, true, "m")
    assert probe.text is None
    acts[0](SimpleNamespace(screen_min=(0.5, -0.1), screen_max=(0.0, 0.2)))
    probe.look(stage, None, estimated, true, "m")
    assert probe.text == "3 particles; estimated mean 3 mm, worst 5 mm; true mean 5 mm, worst 10 mm"
    probe.look(stage, None, None, true, "m")
    assert probe.text == "3 particles; true mean 5 mm, worst 10 mm"
    acts[0](SimpleNamespace(screen_min=(0.4, 0.0), screen_max=(0.5, 1.0)))
    probe.look(stage, None, estimated, true, "m")
    assert probe.text is None
