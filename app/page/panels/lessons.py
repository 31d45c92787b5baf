"""The Lessons tab: what lies in ``lessons/``, as it is written there."""

from pathlib import Path

import viser

LESSONS = Path(__file__).resolve().parents[3] / "lessons"


def add_lessons(gui: viser.GuiApi) -> None:
    """One folder a lesson, titled by the lesson's first line; the first lies open."""
    for k, path in enumerate(sorted(LESSONS.glob("*.md"))):
        title, _, text = path.read_text(encoding="utf-8").partition("\n")
        with gui.add_folder(title.lstrip("# ").strip(), expand_by_default=k == 0):
            gui.add_markdown(text.replace("\n## ", "\n#### "))
