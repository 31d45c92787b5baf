"""Random command lines: they are let in, or bad input is one line that names it."""

from __future__ import annotations

import re
from contextlib import ExitStack
from unittest.mock import patch

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.cli import main
from app.commands import commands
from tests.app.commands.test_refusals import SLOW, Begun, begin
from tests.support.random_scenes import ASKED

FLAGS = {name: sorted("--" + field.replace("_", "-") for field in kind.__dataclass_fields__
                      if kind.__dataclass_fields__[field]._field_type.name == "_FIELD")
         for name, kind in commands().items()}
ODD = ["nan", "inf", "-inf", "1e400", "-1e400", "-1", "0", "-0", "1e-400", "5e-324", "", " ", "Ω", "１２", "٣", "1_0",
       "0x10", "9" * 5000, "\n", "\udcff", "\0", "-", "--", "--=", "-h ", "None", "True", "a" * 300, "no/such/x.json",
       ".", "x.png"]
FINE = ["8", "12", "2", "1e1", "0.05", "0.3", "1e-3", "mpm", "ugimp", "cpdi", "grid", "node", "none", "all", "truth",
        "x", "truth,energy", "transport", "auto", "frozen-weights", "serial", "polar", "1", "3", "out.json"]

here = settings(max_examples=15 if ASKED is None else ASKED, derandomize=ASKED is None, database=None,
                suppress_health_check=list(HealthCheck))
words = st.one_of(st.sampled_from(ODD), st.sampled_from(FINE),
                  st.text(max_size=4).filter(lambda text: "-h" not in text))


def lines(name: tuple[str, ...], most: int) -> st.SearchStrategy[list[str]]:
    flags = st.sampled_from([*FLAGS[name], "--celss", "--no-quiet", "--=", "--Ω"])
    part = st.tuples(flags, st.lists(words, max_size=2)).map(lambda pair: [pair[0], *pair[1]])
    equal = st.tuples(flags, words).map(lambda pair: [f"{pair[0]}={pair[1]}"])
    return st.lists(st.one_of(part, equal, words.map(lambda word: [word])), max_size=most).map(
        lambda parts: [word for part in parts for word in part])


@pytest.mark.parametrize("name", [
    pytest.param(name, id="-".join(name), marks=pytest.mark.slow if name[-1] in ("ring", "vortex") else ())
    for name in commands()])
def test_random_command_lines_end_as_they_should(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)

    @here
    @given(lines(name, 3))
    def ends(arguments):
        capsys.readouterr()
        begun = False
        line = [*name, *arguments]
        with ExitStack() as patches:
            for place in SLOW:
                patches.enter_context(patch(place, begin))
            try:
                status = main(line)
            except Begun:
                begun, status = True, 0
        said = capsys.readouterr().err
        assert status in (0, 1, 2) and "Traceback" not in said
        if status == 2:
            assert said.startswith("mpm-lab: ") and said.count("\n") == 1
            flag = re.match(r"mpm-lab: (--[\w-]+)", said)
            assert flag is None or any(word.startswith(flag[1]) for word in line) or flag[1] in ("--out", "--tolerance")
        else:
            # Of many handed-in files one that is not there is told, and the others are graded.
            assert begun or status != 1 or name == ("lesson", "grade"), said

    ends()
