"""Where things lie, from wherever a test is."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ASSETS, LESSONS = ROOT / "assets", ROOT / "lessons"
