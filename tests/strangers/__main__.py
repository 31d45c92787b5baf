"""``python -m tests.strangers`` judges all codes anew, or those named: assets/strangers.json and strangers.md.

With ``--table`` the text alone is written, from the numbers that are there. It needs ``uv``, the package registries,
the Pythons that ``listed.py`` names and some twenty minutes; a code that stops is told of and keeps its last numbers.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path

from tests.paths import ASSETS
from tests.strangers.listed import STRANGERS
from tests.strangers.record import Place, Stopped, recorded
from tests.strangers.table import page

RECORD, PAGE = ASSETS / "strangers.json", ASSETS / "strangers.md"


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.strangers", description=__doc__)
    parser.add_argument("scripts", nargs="*", metavar="SCRIPT", choices=[*(one.script for one in STRANGERS), []],
                        help="codes by the names of their scripts (default: all)")
    parser.add_argument("--table", action="store_true", help="run nothing, write the text from the numbers there are")
    asked = parser.parse_args()
    kept = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    stopped = False
    with tempfile.TemporaryDirectory(prefix="strangers-") as folder:
        place = Place(Path(folder))
        for stranger in STRANGERS if not asked.table else ():
            if asked.scripts and stranger.script not in asked.scripts:
                continue
            work = place.folder / f"of-{stranger.script}"
            work.mkdir()
            try:
                kept[stranger.script] = recorded(stranger, place.python(stranger), work, place.surroundings())
                print(f"{stranger.script}: judged", flush=True)
            except Stopped as error:
                stopped = True
                print(f"{stranger.script}: {error}", file=sys.stderr, flush=True)
            RECORD.write_text(json.dumps(kept, indent=1, sort_keys=True, ensure_ascii=False) + "\n", encoding="utf-8")
    PAGE.write_text(page(kept), encoding="utf-8")
    return 1 if stopped else 0


if __name__ == "__main__":
    sys.exit(main())
