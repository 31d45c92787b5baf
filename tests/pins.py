"""The exact versions in pyproject.toml, which ``uv run`` installs: ``uv run python -m tests.pins`` renews them.

They are constraints, not a lock file, because that names the addresses of its packages."""

import re
import subprocess
from pathlib import Path

PROJECT = Path(__file__).parents[1] / "pyproject.toml"
PINS = re.compile(r'^((?:build-)?constraint-dependencies) = \[.*?^\]$', re.MULTILINE | re.DOTALL)
PLAIN = ("--no-header", "--no-annotate", "--quiet")
WIDTH = 120


def toml_list(requirements: str) -> str:
    """A line of requirements each as a list in TOML, several to a line."""
    lines = [""]
    for item in (f'"{requirement}",' for requirement in requirements.splitlines()):
        if len(lines[-1]) + 1 + len(item) > WIDTH:
            lines.append("")
        lines[-1] += f"{' ' if lines[-1] else '    '}{item}"
    return "\n".join(("[", *lines, "]"))


def newest(text: str) -> dict[str, str]:
    """The newest versions that a project's file allows without constraints, by the list in which they belong."""
    def said(*command: str, given: str = "") -> str:
        return subprocess.run(command, input=given, cwd=PROJECT.parent, check=True, stdout=subprocess.PIPE,
                              text=True).stdout

    PROJECT.write_text(PINS.sub(r"\1 = []", text), encoding="utf-8")
    said("uv", "lock", "--upgrade", "--quiet")
    built_by = re.search(r'^requires = \["(.*)"\]$', text, re.MULTILINE)[1]
    return {"constraint-dependencies": said("uv", "export", "--frozen", "--all-groups", "--all-extras", "--no-hashes",
                                            "--no-emit-project", *PLAIN),
            "build-constraint-dependencies": said("uv", "pip", "compile", "--universal", "-", *PLAIN, given=built_by)}


if __name__ == "__main__":
    before = PROJECT.read_text(encoding="utf-8")
    after = before
    try:
        pins = newest(before)
        after = PINS.sub(lambda found: f"{found[1]} = {toml_list(pins[found[1]])}", before)
    finally:
        PROJECT.write_text(after, encoding="utf-8")
