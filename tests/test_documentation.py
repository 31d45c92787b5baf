"""What the texts tell a reader to type is so: every command is read by the parser that a reader meets, and run where it
takes seconds; modules, tools and files are there; Python runs as it stands. And what the paper and the report of
accessibility name is there."""

from __future__ import annotations

import importlib.util
import re
import sys
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from app import shareable_state
from app.cli import main
from app.commands import BODY_FILE, commands
from solvers.problems import PROBLEMS
from tests import texts
from tests.support.paths import ROOT
from tests.support.processes import run_python
from tests.texts import Piece

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

LAB = "mpm-lab"
#: What is run here, as it stands in a block, and how: at once, or with ``--slow``.
AT_ONCE = (("body", "list"), ("run", "--scene"), ("problem", "ring"), ("lesson", "list"), ("lesson", "scripts"))
SLOW = (("run", "bar"), ("run", "ring"), ("run", "vortex"), ("budget", "bar"), ("budget", "ring"), ("export",),
        ("lesson", "check"), ("lesson", "guide"), ("advise", "bar"), ("sweep", "bar"), ("tables",))
#: What is read here and run elsewhere, for it ends only when it is told to, measures for long, or asks for files.
ELSEWHERE = {("serve",): "tests/browser", ("bench",): "tests/app/commands/test_bench.py",
             BODY_FILE: "tests/app/commands/test_body_command.py",
             ("body", "show"): "tests/app/commands/test_body_command.py",
             ("judge", "ring"): "tests/solvers/judging", ("check",): "tests/app/commands/test_check.py",
             ("coverage", "bar"): "tests/solvers/study/test_coverage.py",
             ("coverage", "body"): "tests/solvers/study/test_cantilever_coverage.py",
             ("lesson", "grade"): "tests/app/lessons", ("lesson", "scripts"): "tests/app/lessons",
             ("stability", "bar"): "tests/solvers/study", ("stability", "ring"): "tests/solvers/study"}
ON_A_GPU = "--arch"  # a size that only a GPU runs in minutes: tests/solvers/running/test_gpu.py
#: The exit status of a run that breaks, and what is shown because it does: hat functions, and all in this patch test.
BROKEN, SHOWN = 3, re.compile(r"\bpatch\b|\bmpm\b")
#: Which package has a tool that is not called like it.
PACKAGES = {"lint-imports": "import-linter", "sphinx-build": "sphinx", "jupyter": "jupyterlab"}


def after_uv(words: list[str]) -> tuple[list[str], list[str]]:
    """What is run, without settings of the environment, ``uv run`` and its options; and the groups that these name."""
    groups = []
    while words and re.fullmatch(r"\w+=\S*", words[0]):
        words = words[1:]
    if words[:3] == ["python3", "-m", "uv"]:  # where the shell does not find it
        words = words[2:]
    if words[:2] == ["uv", "run"]:
        words = words[2:]
        while words and words[0].startswith("-"):
            groups += words[1:2] if words[0] == "--group" else []
            words = words[2:] if words[0] in ("--group", "-p", "--python", "--extra", "--with") else words[1:]
    return words, groups


def in_blocks() -> list[Piece]:
    """The lines of blocks that call the lab, each once."""
    found = {tuple(after_uv(texts.words(piece.text))[0]): piece for piece in texts.command_lines()}
    return [piece for words, piece in found.items() if words[:1] == (LAB,)]


def named(words: list[str]) -> tuple[str, ...]:
    """The name of the command that the words after ``mpm-lab`` begin with."""
    if words[1:2] and words[1].endswith(".toml"):
        return BODY_FILE
    return next((name for name in commands() if tuple(words[:len(name)]) == name), ("serve",))


@pytest.fixture
def asked(monkeypatch) -> list:
    """The commands that the lab was asked for: read, with all that they say of a scene, and not executed."""
    seen: list = []

    def execute(command) -> int:
        seen.append(command)
        if hasattr(command, "SCENE") and hasattr(command, "scene") and not hasattr(command, "axes"):
            command.scene()  # one scene, whose rules say no in a SceneError
        return 0

    for kind in set(commands().values()):
        monkeypatch.setattr(kind, "execute", execute)
    return seen


def test_every_command_in_a_block_is_read_as_it_stands(asked, capsys):
    pieces = in_blocks()
    assert len(pieces) > 40
    for piece in pieces:
        (_, *words), _ = after_uv(texts.words(piece.text))
        assert main(words[:words.index(">")] if ">" in words else words) == 0, f"{piece}\n{capsys.readouterr().err}"
    assert len(asked) == sum("--completion" not in piece.text for piece in pieces)  # which is no command


def test_every_command_in_a_line_is_read_with_an_example_in_each_place(asked, capsys):
    """Whoever only names commands gives the beginning of one, or leaves the problem out: ``mpm-lab run --json``."""
    pieces = [piece for piece in texts.spans() if re.match(rf"(uv run )?{LAB}( |$)", piece.text)]
    assert len(pieces) > 40
    for piece in pieces:
        for text in texts.examples(piece.text):
            (_, *words), _ = after_uv(texts.words(text))
            if any(name[:len(words)] == tuple(words) for name in commands()):
                continue
            tries = [words, [words[0], "bar", *words[1:]]]
            if "--scene" in words[-1:]:
                tries = [[*words, "bar"]]
            assert any(main(some) == 0 for some in tries), f"{piece}\n{capsys.readouterr().err}"
    assert len(asked) > 20


def test_scenes_in_a_line_are_scenes():
    """Such as ``bar method=mpm cells=80``."""
    problem = rf"({'|'.join(PROBLEMS)})[ ;][\w-]+="
    found = [piece for piece in texts.spans() if re.match(problem, piece.text) and "{" not in piece.text]
    assert found
    for piece in found:
        shareable_state.parse_state(piece.text.replace("...", ""))


def test_other_tools_and_the_files_that_they_take_are_there():
    groups = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["dependency-groups"]
    packages = {re.match(r"[\w.-]+", line)[0] for lines in groups.values() for line in lines}
    seen = 0
    for piece in (*texts.command_lines(), *texts.spans()):
        if not re.match(r"(\w+=\S+ )*(uv run|python3? -m) \S", piece.text):
            continue
        (tool, *rest), asked_groups = after_uv(texts.words(piece.text))
        if tool == LAB:
            continue
        seen += 1
        assert set(asked_groups) <= set(groups), piece
        if tool in ("python", "python3"):
            module = rest[rest.index("-m") + 1] if "-m" in rest else None
            assert importlib.util.find_spec(module) if module else (ROOT / rest[0]).is_file(), piece
        else:
            assert PACKAGES.get(tool, tool) in packages, piece
    assert seen > 10


def test_links_to_elsewhere_are_whole():
    """Encrypted, but to this machine, with the name of a host; and no space or bracket within."""
    found = [piece for piece in texts.links() if urlsplit(piece.text).scheme]
    assert found
    for piece in found:
        parts = urlsplit(piece.text)
        assert parts.scheme == "https" or parts.hostname in ("127.0.0.1", "localhost"), piece
        assert re.fullmatch(r"[\w-]+(\.[\w-]+)+", parts.hostname), piece
        assert re.fullmatch(r"[^\s<>\"{}|^`]+", piece.text), piece


def test_files_that_a_text_names_are_there():
    """A ``NAME`` in a path is any problem or estimator: then one such file is."""
    found = list(texts.paths())
    assert len(found) > 60
    for piece in found:
        pattern = texts.PLACE.sub("*", piece.text.rstrip("/"))
        assert next(ROOT.glob(pattern), None) is not None, piece


def test_python_of_a_page_runs_from_top_to_bottom(tmp_path):
    """In a process of its own, as a reader would: the blocks of a page one after the other."""
    pieces = list(texts.python_blocks())
    for page in sorted({piece.page for piece in pieces}):
        code = "\n".join(piece.text for piece in pieces if piece.page == page)
        done = run_python("-c", code, cwd=tmp_path, MPLBACKEND="agg")
        assert done.returncode == 0, f"{page}: {done.stderr}"
        if page == "README.md":
            assert re.search(r"largest error of x in m: \S+ estimated over true error: (1\.00|0\.99)\d*\n", done.stdout)


def test_each_command_in_a_block_is_run_somewhere():
    used = {named(after_uv(texts.words(piece.text))[0][1:]) for piece in in_blocks()}
    assert used <= {*AT_ONCE, *SLOW, *ELSEWHERE}, "a command that is new in a text: say above where it is run"
    assert all((ROOT / place).exists() for place in ELSEWHERE.values())


@pytest.mark.parametrize("some", [AT_ONCE, pytest.param(SLOW, marks=pytest.mark.slow)], ids=["at once", "slow"])
def test_commands_in_blocks_do_what_they_are_there_for(some, tmp_path: Path, monkeypatch, capsys):
    """They end well, but for runs that are shown because they break, and leave what they name."""
    for k, piece in enumerate(in_blocks()):
        words = after_uv(texts.words(piece.text))[0][1:]
        if named(words) not in some or ON_A_GPU in words:
            continue
        folder = tmp_path / str(k)
        folder.mkdir()
        monkeypatch.chdir(folder)
        status = main(words)
        assert status == 0 or (status == BROKEN and SHOWN.search(piece.text)), f"{piece}\n{capsys.readouterr().err}"
        files = [words[n + 1] for n, flag in enumerate(words) if flag in ("--plot", "--out", "--particles")]
        assert all((folder / name).exists() for name in files), piece


PAPER = ROOT / "assets" / "paper"


def test_what_the_paper_cites_is_in_its_bibliography_and_the_other_way_round():
    text, entries = (PAPER / "paper.md").read_text(encoding="utf-8"), (PAPER / "paper.bib").read_text(encoding="utf-8")
    listed = re.findall(r"^@\w+{(\w+),", entries, re.M)
    cited = set(re.findall(r"(?<![\w.])@(\w+)", text.partition("\n---\n")[2]))
    assert len(listed) == len(set(listed)) and set(listed) == cited
    assert entries.count("{") == entries.count("}")
    for entry in re.split(r"^@", entries, flags=re.M)[1:]:
        assert "year" in entry and ("doi" in entry or "eprint" in entry), entry


def test_numbers_of_the_paper_are_those_of_the_texts():
    """Each number appears in the paper and in the documentation with the same wording."""
    paper, readme, budget = (" ".join((ROOT / path).read_text(encoding="utf-8").split())
                             for path in ("assets/paper/paper.md", "README.md", "assets/budget.md"))
    for number in ("88 of 90 random trials", "97 %", "14 %", "87 %"):
        assert number in paper and number in budget, number
    assert "Ten lessons" in readme and "ten lessons" in paper


REPORT = (ROOT / "assets" / "accessibility.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| (\d\.\d\.\d+) (.+?) \| (AA?) \| (.+?) \| (.+?) \| (.*?) \|$", re.MULTILINE)
VERDICTS = {"supported", "partly", "not", "does not apply"}


def test_each_criterion_of_accessibility_is_listed_once():
    """All of WCAG 2.1 of the levels A and AA."""
    rows = ROW.findall(REPORT)
    assert len({number for number, *_ in rows}) == len(rows) == len(re.findall(r"^\| \d", REPORT, re.M)) == 50
    assert [level for _, _, level, *_ in rows].count("AA") == 20


def test_each_verdict_is_one_of_four_and_has_a_reason():
    for number, _, _, verdict, looked_at, shown in ROW.findall(REPORT):
        assert verdict in VERDICTS and looked_at.endswith("."), number
        assert shown or verdict != "supported", f"{number} is said to be supported, and nothing shows it"


def test_each_test_that_is_named_is_there():
    named = re.findall(r"`(tests/[\w/]+\.py)::(\w+)`", REPORT)
    assert len(named) > 20
    for path, name in named:
        assert f"def {name}(" in (ROOT / path).read_text(encoding="utf-8"), f"{path}::{name}"
    cells = " ".join(shown for *_, shown in ROW.findall(REPORT))
    assert len(re.findall(r"tests/[\w/]+\.py", cells)) == len(named)
