"""The sentences of the solvers that a visitor of the page may read, found in their code, those about links, and the
words of the solvers' registries: as templates with places, ``give a whole number from {least} to {most}``, for
``app/language/de.po``."""

import ast
import re
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path

from solvers.problems import PROBLEMS
from solvers.scene.effects import ALL, Line
from solvers.scene.error_causes import CAUSES
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.scene.remedies import REMEDIES
from solvers.scene.validation import field_label
from solvers.solver.soundness import NOUNS
from tests.support.paths import ROOT

#: Where they stand.
FILES = ("motion/formula.py", "motion/typed_motion.py", "scene/validation.py", "scene/scene.py", "scene/typed.py",
         "scene/step_bound.py", "scene/estimator_registry.py", "scene/effects.py", "problems/[!_]*.py",
         "problems/*/problem.py", "problems/*/scene.py", "problems/planar/box.py", "problems/*/limits.py",
         "problems/bar/patch_test.py", "problems/*/solver.py", "problems/*/estimators/recovered_tables.py",
         "problems/planar/budget/on_demand.py", "estimators/companion.py", "estimators/two_grid_dispersion.py",
         "estimators/recovery.py", "estimators/transport.py", "estimators/two_grid.py", "solver/base.py",
         "solver/soundness.py", "solver/verdict_basis.py", "solver/budget.py", "solver/rounding.py",
         "running/budget.py", "running/scene_text.py", "engine/engine_pool.py", "engine/engine_worker.py",
         "engine/engine_process.py", "untrusted/size_limits.py", "untrusted/npz_reader.py", "untrusted/quoting.py",
         "study/advise.py", "study/background_jobs.py",
         *(f"judging/findings/{name}.py" for name in ("outliers", "completeness", "evidence", "constitutive_law",
                                                      "all_findings", "time_consistency", "placement")),
         *(f"judging/{name}.py" for name in ("column_names", "frames", "particle_matching", "particle_readers",
                                             "scene_metadata", "file_view", "judgement")))
#: Calls whose texts are for the command line and logs alone, and names that tables have.
NOT_SAID = ("option", "debug", "info", "warning", "error", "exception", "compile", "on_progress", "unknown")
NAMES = re.compile("[A-Z_]*(NAMES?[A-Z_]*|UNITS?|SETTING|PLACES|SPEEDS|CLOCK|VELOCITY|STRESS|ORDER|DRIFT|AXES|FIGURES)")
#: What else is for nobody's eyes, by how it begins.
SILENT = ("%d ", "<", "of the ", "times ", "does not hold", "cannot be told", "double precision", "single precision")
WORD = re.compile(r"[^\W\d_]{2,}")
PLACE, FORMAT = re.compile(r"\{(\w+)\}"), re.compile(r"\{(?:scene\.)?(\w+)(?::[^{}]*)?\}")
Text = tuple[str, str]  # a template, and the file where it stands


def sentences() -> Iterator[Text]:
    """All of them."""
    for pattern in FILES:
        for path in sorted((ROOT / "solvers").glob(pattern)):
            yield from _in(path)
    yield from _in(ROOT / "app" / "state.py")
    yield from _registries()


def _in(path: Path) -> Iterator[Text]:
    for text in _of(ast.parse(path.read_text(encoding="utf-8"))):
        yield text, path.relative_to(ROOT).as_posix()


def _of(tree: ast.AST) -> Iterator[str]:
    for node, nested in _literals(tree):
        text = _template(node)
        words = WORD.findall(PLACE.sub(" ", text))
        said = len(words) > 1 or (words and PLACE.search(text)) if " " in text.strip() else nested
        least = 2 if text.endswith(" ") else 3  # letters of a word: "or " begins what follows
        if said and max(map(len, words), default=0) >= least and not text.startswith(SILENT):
            yield text


def _literals(node: ast.AST, nested: bool = False) -> Iterator[tuple[ast.expr, bool]]:
    """The texts of code, outermost first, and whether they stand in the place of another one."""
    match node:
        case ast.Expr(value=ast.Constant()) | ast.Raise(exc=ast.Call(func=ast.Name(id="RuntimeError"))) | ast.Assert():
            return  # a docstring, and what only we make wrong
        case ast.FunctionDef(args=ast.arguments(args=[ast.arg(annotation=ast.Name(id="Motion")), *_])):
            return  # of the motion of any particles, which a page does not show
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)) if name in NOT_SAID:
            return
        case ast.Assign(targets=[ast.Name(id=name) | ast.Tuple(elts=[ast.Name(id=name), *_])]) if NAMES.fullmatch(name):
            return
        case ast.JoinedStr():
            yield node, nested
            for part in node.values:
                if isinstance(part, ast.FormattedValue):
                    yield from _literals(part.value, True)
        case ast.Constant(value=str()):
            yield node, nested
        case _:
            for child in ast.iter_child_nodes(node):
                yield from _literals(child, nested)


def _template(node: ast.expr) -> str:
    """A literal as a template: what stands between its words are places, named after what is put there; two side by
    side are one."""
    if isinstance(node, ast.Constant):
        return FORMAT.sub(r"{\1}", str(node.value))
    assert isinstance(node, ast.JoinedStr)
    text, names, after = "", list[str](), False
    for part in node.values:
        if isinstance(part, ast.Constant):
            text, after = text + str(part.value), False
        elif isinstance(part, ast.FormattedValue) and not after:
            name = _name(part.value)
            names.append(name)
            count = names.count(name)
            text, after = f"{text}{{{name}{count if count > 1 else ''}}}", True
    return text


def _name(node: ast.AST) -> str:
    """What a place is called after what is put there: ``self.cells`` is cells, ``SAFE * bound.longest`` longest."""
    found = [name for name in _mentioned(node) if name != "self"]
    return next((name for name in found if not name.isupper()), found[0] if found else "value").lower().strip("_")


def _mentioned(node: ast.AST) -> Iterator[str]:
    match node:
        case ast.Attribute(value=value, attr=name):
            yield name
            yield from _mentioned(value)
        case ast.Name(id=name):
            yield name
        case ast.Call(func=func, args=args):
            for arg in args:
                yield from _mentioned(arg)
            if isinstance(func, ast.Attribute):
                yield from _mentioned(func.value)
                if not args:
                    yield func.attr
        case _:
            for child in ast.iter_child_nodes(node):
                yield from _mentioned(child)


def _registries() -> Iterator[Text]:
    scene = "solvers/scene"
    for problem in PROBLEMS.values():
        own = f"solvers/problems/{problem.scene.problem}/scene.py"
        yield from ((text, own) for text in (problem.scene.problem, problem.scene.TITLE))
        for field in fields(problem.scene):
            yield field_label(field.name), own
    for cause in CAUSES.values():
        yield cause, f"{scene}/causes.py"
    for remedy in REMEDIES.values():
        yield from ((text, f"{scene}/remedies.py") for text in (remedy.label, remedy.explanation))
    for effect in ALL.values():
        lines = (line for line in (effect.text, effect.readout) if isinstance(line, Line))
        texts = (effect.label, effect.explanation, effect.elsewhere,
                 *(text for line in lines for text in (line.name, line.words, line.hint)))
        yield from ((text, f"{scene}/effects.py") for text in texts if WORD.search(PLACE.sub("", text)))
    for estimator in ESTIMATORS.values():
        yield estimator.summary, f"{scene}/registry.py"
    for noun in NOUNS.values():
        yield noun, "solvers/solver/soundness.py"
    for count in ("no", "one", "two", "three"):
        yield count, "solvers/judging/particle_matching.py"
