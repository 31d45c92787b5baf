"""Lessons in a system that others have written: ``python -m tests.scorm_again [PACKAGE.zip]``. Prints what it finds.

Fetches the npm package scorm-again, and plays each lesson of a package (``mpm-lab export 1 4 8 --scorm``, if none is
given) in a real browser to its middle, closes it, comes back, and plays it to its end.
"""

import io
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from pathlib import Path

from app.export.course import package
from app.lessons import shelf
from tests.browser import courses
from tests.browser.conftest import FLAGS, _browser

PACKAGE, SCRIPT = "scorm-again", "package/dist/scorm12.js"
#: It says what it refuses on the console, which fails; and what has been kept is asked of it at the end of a visit.
SYSTEM = """
const system = {record: null};
system.begin = () => {
  window.API = new Scorm12API({logLevel: 5, selfReportSessionTime: true});
  if (system.record) window.API.loadFromJSON(system.record);
  window.API.on("LMSCommit", () => { system.record = JSON.parse(JSON.stringify(window.API.cmi)); });
};
window.system = system;
"""


def main(given: list[str]) -> int:
    packed = Path(given[0]).read_bytes() if given else package(
        [shelf.lesson(shelf.called(name)) for name in ("1", "4", "8")], 2, lambda part, what: None)
    files = [name for name in zipfile.ZipFile(io.BytesIO(packed)).namelist() if name.endswith(".html")]
    print(f"{len(packed) / 1e6:.1f} MB: {', '.join(files)}")
    from playwright.sync_api import sync_playwright  # here: tests that have no browser import the others of its folder

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=_browser(), args=FLAGS)
        with courses.course(browser, packed, fetched() + SYSTEM) as page:
            wrong = [sentence for file in files for sentence in played(page, file)]
        browser.close()
    print("\n".join(wrong) or "all is as it should be")
    return int(bool(wrong))


def fetched() -> str:
    """The package's script."""
    with tempfile.TemporaryDirectory() as folder:
        name = subprocess.run(["npm", "pack", PACKAGE, "--silent"], cwd=folder, check=True, text=True,
                              stdout=subprocess.PIPE).stdout.strip()
        print(name)
        with tarfile.open(Path(folder, name)) as archive:
            found = archive.extractfile(SCRIPT)
            assert found is not None
            return found.read().decode().replace("</script", "<\\/script") + "\n"


def played(page, file: str) -> list[str]:
    """What is not as it should be."""
    page.evaluate("() => { system.record = null; system.begin(); }")
    frame = courses.opened(page, file)
    steps = courses.steps(frame)
    middle, asked = len(steps) // 2, sum(step["question"] is not None for step in steps)
    courses.walked(frame, middle)
    courses.closed(page)
    page.evaluate("system.begin()")
    frame = courses.opened(page, file)
    where = frame.locator("#where").inner_text()
    courses.walked(frame)
    record = page.evaluate("system.record")
    courses.closed(page)
    core = record["core"]
    found = {"resumes at": where, "status": core["lesson_status"], "score": core["score"]["raw"],
             "characters": len(record["suspend_data"]), "interactions": len(record["interactions"])}
    print(f"{file}: {found}")
    right = {"resumes at": f"Step {middle} of {len(steps)}", "status": "completed", "score": "100",
             "interactions": asked}
    return [f"{file}: {name} is {found[name]!r}, not {value!r}" for name, value in right.items()
            if found[name] != value]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
