"""What the page says of a body whose estimate ends before the run does."""

from dataclasses import asdict

import numpy as np
import pytest

from app.frame.body_sentences import body_facts, body_headline
from app.frame.shown_body import BodySource, ShownBody
from solvers.bodies.body_file import LIBRARY, read_body
from solvers.bodies.body_run_worker import FIELDS, BodyRunSummary, BodySample
from solvers.bodies.goal_values import GoalValue

FOLDED = "from t = 0.3 s the companions have failed"


@pytest.fixture
def body(tmp_path):
    """A beam that has sunk for 0.3 s, the last 0.1 s without an estimate."""
    file, table = LIBRARY / "cantilever.toml", tmp_path / "table"
    np.zeros((4, 2, FIELDS), np.float32).tofile(table)
    shown = ShownBody(BodySource(file, "beam"), table,
                      asdict(BodyRunSummary(asdict(read_body(file)), 2, 3, 0.1, 1.0, [])))
    for k in (1, 2, 3):
        value, bar = 0.5 - 0.1 * k, None if k == 3 else 0.01
        shown.add(BodySample(0.1 * k, {name: GoalValue(value, bar, "m") for name in shown.goals},
                             {name: (value, bar) for name in shown.goals}, FOLDED * (k == 3))._asdict())
    return shown


def test_a_value_without_a_bar_comes_with_the_reason(body):
    said = str(body_headline(body))
    assert said.startswith("Lowest: (4, 0.5) sinks to y = 200 mm, without a bar: no estimate after t = 0.2 s, so far.")
    assert "From t = 0.3 s the companions have failed." in said


def test_an_estimate_is_of_the_frames_before_its_end(body):
    assert body.error_sizes(2, "x") is not None and body.error_sizes(3, "x") is None
    assert body_facts(body, 3, "x") == (("", "no estimate after t = 0.2 s"),)
