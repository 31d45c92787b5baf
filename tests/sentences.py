"""The sentences of the solvers, those about links, and the words of the solvers' registries: as templates with places,
``give a whole number from {least} to {most}``, for ``app/language/de.po``."""

import ast
import re
from collections.abc import Iterator
from dataclasses import fields

from solvers.judging.findings.constitutive_law import MEASURES
from solvers.problems import PROBLEMS
from solvers.problems.planar.problem import PlanarProblem
from solvers.scene.effects import ALL, OutputLine
from solvers.scene.error_causes import CAUSES
from solvers.scene.estimator_registry import ESTIMATORS, PROCESSOR_REASON
from solvers.scene.stabilisations import REMEDIES
from solvers.scene.validation import field_label
from solvers.solver.soundness import CONTRADICTIONS
from solvers.translatable_message import Message
from tests.support.paths import ROOT

#: Calls with a template, and which of their arguments it is.
CALLS = {"Message": 0, "join_messages": 0, "FormulaError": 0, "StateError": 0, "partial": 1, "FileError": 1,
         "SceneError": 2}
WORD = re.compile(r"[^\W\d_]{2,}")
PLACE, FORMAT = re.compile(r"\{(\w+)\}"), re.compile(r"\{(?:\w+\.)*(\w+)(?::[^{}]*)?\}")
Text = tuple[str, str]  # a template, and the file where it stands


def sentences() -> Iterator[Text]:
    """All of them."""
    for text, file in (*_templates(), *_registries()):
        bare = FORMAT.sub(r"{\1}", text)
        if WORD.search(PLACE.sub("", bare)):
            yield bare, file


def _templates() -> Iterator[Text]:
    for path in (*sorted((ROOT / "solvers").rglob("*.py")), ROOT / "app" / "shareable_state.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            match node:
                case ast.Call(func=ast.Name(id=name), args=args) if len(args) > CALLS.get(name, len(args)):
                    yield from ((text, path.relative_to(ROOT).as_posix()) for text in _texts(args[CALLS[name]]))


def _texts(node: ast.expr) -> Iterator[str]:
    match node:
        case ast.Constant(value=str(text)):
            yield text
        case ast.IfExp(body=one, orelse=other):
            yield from (*_texts(one), *_texts(other))


def _registries() -> Iterator[Text]:
    scene = "solvers/scene"
    for problem in PROBLEMS.values():
        own = f"solvers/problems/{problem.scene.problem}/scene.py"
        kind = problem.scene
        whys = (limit.why for limit in kind.LIMITS if not isinstance(limit.why, Message))
        yield from ((text, own) for text in (kind.problem, kind.TITLE, *whys))
        if isinstance(problem, PlanarProblem):
            view = problem.showing
            yield from ((text, own) for text in (view.amplitude_hint, view.modulus_hint, view.poisson_hint,
                                                 *view.details.values(), view.breaking[0]))
        for field in fields(problem.scene):
            yield field_label(field.name), own
    for cause in CAUSES.values():
        yield cause, f"{scene}/error_causes.py"
    for remedy in REMEDIES.values():
        yield from ((text, f"{scene}/stabilisations.py") for text in (remedy.label, remedy.explanation))
    for effect in ALL.values():
        lines = (line for line in (effect.text, effect.readout) if isinstance(line, OutputLine))
        texts = (effect.label, effect.explanation, effect.elsewhere,
                 *(text for line in lines for text in (line.name, line.words, line.hint)))
        yield from ((text, f"{scene}/effects.py") for text in texts)
    for estimator in ESTIMATORS.values():
        texts = (estimator.summary, *estimator.refusals.values(), PROCESSOR_REASON)
        yield from ((text, f"{scene}/estimator_registry.py") for text in texts)
    for words in MEASURES:
        yield words, "solvers/judging/findings/constitutive_law.py"
    for rule in CONTRADICTIONS.values():
        yield rule.sentence, "solvers/solver/soundness.py"
