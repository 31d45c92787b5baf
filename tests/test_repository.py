"""What other people's machines and readers find beside the code: workflows, forms, advice.

Workflows run elsewhere; here each is read, and what it would type exists.
"""

from __future__ import annotations

import ast
import os
import re
import shlex
import shutil
import sys
from itertools import chain

import pytest
import yaml

from app import __version__
from app.commands.dispatch import commands
from tests.groups import MODULES
from tests.support.paths import ROOT

if sys.version_info >= (3, 11):
    import tomllib
else:  # mypy brings it
    import tomli as tomllib

GITHUB = ROOT / ".github"
WORKFLOWS = sorted((GITHUB / "workflows").glob("*.yml"))
FORMS = sorted(path for path in (GITHUB / "ISSUE_TEMPLATE").glob("*.yml") if path.name != "config.yml")
#: What a fresh machine has, or a package manager brings before it is called.
THERE = {"apt-get", "dnf", "python", "python3", "pip", "uv"}
FIELDS = {"markdown": "value", "textarea": "label", "input": "label", "dropdown": "label", "checkboxes": "label"}
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def read(path):
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def jobs(path):
    return read(path)["jobs"].values()


def lines(path):
    """What a workflow types, command by command; strings of a matrix stand for themselves."""
    for step in chain.from_iterable(job["steps"] for job in jobs(path)):
        text = re.sub(r"\$\{\{.*?\}\}", "VALUE", step.get("run", "")).replace("\\\n", " ")
        for line in re.split(r"\n|&&|\|\||;", text):
            if words := shlex.split(line, comments=True):
                yield words


def missing(words):
    """Why a command would not be found, or nothing."""
    name, *rest = words[1:] if words[0] == "sudo" else words
    name = "uv" if name == "~/.uv/bin/uv" else name  # where assets/install.md has pip put it
    if name == "uv" and rest[:1] == ["run"]:
        rest = rest[1:]
        while rest and rest[0].startswith("-"):
            rest = rest[2:] if rest[0] in ("--python", "-p", "--group", "--with") else rest[1:]
        return missing(rest)
    if name == "mpm-lab":
        named = [" ".join(rest[:n]) for n in (1, 2)]
        return "" if any(tuple(part.split()) in commands() for part in named) else f"mpm-lab has no {rest[0]}"
    if "/" in name:
        return "" if os.access(ROOT / name, os.X_OK) else f"{name} is no program of the repository"
    places = [word for word in rest if re.fullmatch(r"(tests|app|solvers|lessons|assets|\.ci)(/\S*)?", word)]
    gone = [place for place in places if not (ROOT / place).exists()]
    if gone:
        return f"{name}: there is no {gone[0]}"
    return "" if name in THERE or shutil.which(name, path=os.path.dirname(sys.executable)) else f"{name} is not there"


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_what_a_workflow_types_exists(path):
    """On this machine, with all groups."""
    assert [why for words in lines(path) if (why := missing(words))] == []
    for step in chain.from_iterable(job["steps"] for job in jobs(path)):
        assert ("run" in step) != ("uses" in step) and \
            re.fullmatch(r"[\w./-]+@[0-9a-f]{40}", step.get("uses", f"a/b@{0:040}"))  # a tag may move


def test_the_workflow_tries_the_pythons_that_are_promised():
    """The whole of .ci/run on one of them, the rest in a matrix; macOS and Windows beside Linux."""
    tests = read(GITHUB / "workflows" / "tests.yml")["jobs"]
    whole = re.search(r"python:(\d\.\d+)", tests["everything"]["container"])[1]
    tried = {whole, *tests["pythons"]["strategy"]["matrix"]["python"]}
    promised = {found[1] for name in PROJECT["classifiers"] if (found := re.search(r":: (3\.\d+)$", name))}
    assert tried == promised and any(step.get("run") == ".ci/run" for step in tests["everything"]["steps"])
    assert {system.split("-")[0] for system in tests["smoke"]["strategy"]["matrix"]["system"]} == {"macos", "windows"}
    least, most = re.fullmatch(r">=3\.(\d+),<3\.(\d+)", PROJECT["requires-python"]).groups()
    assert promised == {f"3.{minor}" for minor in range(int(least), int(most))}


def test_the_workflow_types_the_documented_line_where_pip_is_refused():
    steps = read(GITHUB / "workflows" / "tests.yml")["jobs"]["marked"]["steps"]
    given = re.search(r"pip install -q --target .*uv run mpm-lab",
                      (ROOT / "assets" / "install.md").read_text(encoding="utf-8"))[0]
    assert steps[-1]["run"].startswith(given)


@pytest.mark.parametrize("path", FORMS, ids=lambda path: path.stem)
def test_a_form_can_be_filled_in(path):
    form = read(path)
    assert form["name"] and form["description"]
    ids = [field["id"] for field in form["body"] if field["type"] != "markdown"]
    assert len(ids) == len(set(ids)) > 0
    for field in form["body"]:
        assert field["attributes"][FIELDS[field["type"]]]
    typed = re.findall(r"`mpm-lab ([^`]*)`", path.read_text(encoding="utf-8"))
    assert typed and [text for text in typed if text != "--version" and missing(["mpm-lab", *text.split()])] == []


@pytest.mark.parametrize("name", ["SECURITY.md", "CODE_OF_CONDUCT.md", "SUPPORT.md"])
def test_links_of_the_customs_lead_somewhere(name):
    text = (GITHUB / name).read_text(encoding="utf-8")
    places = [place for place in re.findall(r"\]\(([^)]+)\)", text) if "://" not in place]
    assert places and [place for place in places if not (GITHUB / place).exists()] == []


def test_the_version_is_the_same_wherever_it_stands():
    """In the code, in what is cited, at the top of the changelog with its day, and in the line that tags it."""
    texts = {name: (ROOT / name).read_text(encoding="utf-8")
             for name in ("CITATION.cff", "CHANGELOG.md", "CONTRIBUTING.md")}
    cited = yaml.safe_load(texts["CITATION.cff"])
    number, day = re.findall(r"^## (\d+\.\d+\.\d+), (\d{4}-\d\d-\d\d)$", texts["CHANGELOG.md"], re.M)[0]
    assert (number, day) == (__version__, str(cited["date-released"])) and cited["version"] == __version__
    assert f"git tag -a v{__version__} -m \"mpm-lab {__version__}\"" in texts["CONTRIBUTING.md"]


def test_what_is_installed_is_pinned():
    """Everything that is declared, and what builds the package, to the version; the viewer for pip too, because parts
    of it are used that it promises to nobody."""
    whole = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    declared = chain(PROJECT["dependencies"], *PROJECT["optional-dependencies"].values(),
                     *whole["dependency-groups"].values(), whole["build-system"]["requires"])
    pins = [*whole["tool"]["uv"]["constraint-dependencies"], *whole["tool"]["uv"]["build-constraint-dependencies"]]
    assert all(re.fullmatch(r"[\w.-]+==[\w.]+( ; [^;]+)?", pin) for pin in pins)
    assert {re.match(r"[\w.-]+", text)[0] for text in declared} <= {pin.partition("==")[0] for pin in pins}
    assert any(text.startswith("viser==") for text in PROJECT["dependencies"])


def at_import(tree: ast.AST):
    """The names of the modules that a file imports as it is imported: all but those within functions."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module
        elif not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield from at_import(node)


def test_no_test_imports_what_only_another_group_brings():
    """``uv run pytest`` collects with the dependency group ``test`` alone; what others bring is asked for."""
    others = {module for modules in MODULES.values() for module in modules}
    found = {(str(path.relative_to(ROOT)), name) for path in (ROOT / "tests").rglob("*.py")
             for name in at_import(ast.parse(path.read_text(encoding="utf-8"))) if name.partition(".")[0] in others}
    assert not found
