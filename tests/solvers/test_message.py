"""Messages: sentences that remember their template and values."""

import ast
import copy
import json
import pickle
from string import Formatter
from types import SimpleNamespace

import pytest

from solvers.scene.validation import SceneError
from solvers.translatable_message import Message, join_messages, message_from_json, messages_to_json
from tests.sentences import CALLS
from tests.support.paths import ROOT

SCENE = SimpleNamespace(ppc=2.5)
NESTED = Message("give {least:,} or more, {scene.ppc:g} a cell{near}", least=4000, scene=SCENE,
                 near=Message(" (did you mean {close}?)", "bar"))


def test_a_message_is_its_english_text():
    assert NESTED == "give 4,000 or more, 2.5 a cell (did you mean bar?)"
    assert NESTED.template == "give {least} or more, {ppc} a cell{near}"
    assert NESTED.values == {"least": "4,000", "ppc": "2.5", "near": " (did you mean bar?)"}
    assert Message("{} is {what}") == "{} is {what}"  # without values there are no places
    with pytest.raises(ValueError, match="shorter"):
        Message("from {least} to {most}", 1)


@pytest.mark.parametrize("through", [
    lambda message: pickle.loads(pickle.dumps(message)), copy.deepcopy, str, Message,
    lambda message: str(ValueError(message)),
    lambda message: json.loads(json.dumps(messages_to_json([{"sentence": message}])),
                               object_hook=message_from_json)[0]["sentence"]])
def test_a_message_stays_one_on_its_way(through):
    came = through(NESTED)
    assert (came, came.template, came.values) == (NESTED, NESTED.template, NESTED.values)
    assert came.values["near"].values == {"close": "bar"}


def test_messages_are_put_together_as_texts_are():
    parts = "at first: " + NESTED + "; " + Message("leave it out")
    assert parts == f"at first: {NESTED}; leave it out" and isinstance(parts, Message)
    assert join_messages(" or ", ("a", "b", "c")) == "a or b or c"
    assert join_messages(" or ", ()) == "" and (NESTED + "") is NESTED * True and NESTED * False == ""


def test_an_error_is_a_message():
    error = SceneError("cells", 3, "give {least:,} or more", 4000)
    assert str(error) == "cells 3: give 4,000 or more"
    assert error.sentence.template == "give {least} or more"  # type: ignore[attr-defined]


def test_every_template_has_as_many_values_as_places():
    wrong = []
    for path in (*(ROOT / "solvers").rglob("*.py"), ROOT / "app" / "shareable_state.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            match node:
                case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if len(args) > CALLS.get(name, len(args)):
                    template, *values = args[CALLS[name]:]
                    if values and name not in ("join_messages", "partial") and isinstance(template, ast.Constant):
                        places = {place for _, place, _, _ in Formatter().parse(str(template.value)) if place}
                        wrong += [(path.name, node.lineno)] * (len(places) != len(values))
    assert wrong == []
