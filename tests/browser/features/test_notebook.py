"""A run played in a notebook: in a real JupyterLab, and under the rules that others lay on what a cell shows."""

from __future__ import annotations

import html
import os
import subprocess
import sys
from contextlib import closing, suppress
from urllib.request import urlopen

import pytest

from app.notebook import show
from solvers import BarScene
from solvers.workers.worker_process import free_port
from tests.browser.conftest import SIZE
from tests.groups import require_group
from tests.support.processes import HANG, wait_until

CELLS = ["from app.notebook import show\nfrom solvers import BarScene, run\n"
         "scene = BarScene(cells=10, periods=0.25, estimators=('companion',))\nrun(scene)",
         "show(scene, height=600)", "run(scene).plot()"]
SCENE = BarScene(cells=10, periods=0.25, estimators=("companion",))
#: What VS Code lays on a notebook's output where it is told to (the setting notebook.experimental.enableCsp).
VS_CODE = ("default-src 'none'; script-src https: 'unsafe-inline' 'unsafe-eval'; style-src https: 'unsafe-inline'; "
           "img-src https: http: data:; font-src https:; connect-src https:; child-src https: data:;")


@pytest.fixture(scope="module")
def jupyter(tmp_path_factory):
    """The address of a JupyterLab with a notebook of three cells that nobody has run yet."""
    require_group("notebook")
    import nbformat

    root, own = tmp_path_factory.mktemp("notebooks"), tmp_path_factory.mktemp("jupyter")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(text) for text in CELLS], metadata={
        "kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}})
    nbformat.write(notebook, root / "run.ipynb")
    address = f"http://127.0.0.1:{(port := free_port())}"
    with open(own / "log", "w") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", "--IdentityProvider.token=",
             f"--port={port}", "--ServerApp.port_retries=0", f"--ServerApp.root_dir={root}",
             "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate"], stdout=log, stderr=log,
            env={**os.environ, **{f"JUPYTER_{kind}_DIR": str(own / kind) for kind in ("CONFIG", "DATA", "RUNTIME")}})

    def answers() -> bool:
        assert process.poll() is None, (own / "log").read_text()
        with suppress(OSError):
            return urlopen(f"{address}/api").status == 200
        return False

    try:
        wait_until(answers, "JupyterLab")
        yield address
    finally:
        process.terminate()
        process.wait(HANG)


def norm_of(frame) -> str:
    return frame.locator("#norms tr", has_text="true").locator("td").first.inner_text()


def plays_to_its_end(frame) -> None:
    wait_until(lambda: frame.locator("#clock").inner_text() == "0.25 s", "the end of the run")
    assert norm_of(frame).endswith("µm")
    drawn = "canvas => new Set(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data).size"
    assert frame.locator("#stage").evaluate(drawn) > 50  # values of colours: a stage that is drawn, not an empty one


@pytest.mark.slow
def test_a_run_plays_below_its_cell_in_jupyterlab(chromium, jupyter):
    with closing(chromium.new_context(viewport={"width": 1280, "height": 900})) as context:
        page = context.new_page()
        page.set_default_timeout(1e3 * HANG)
        page.goto(f"{jupyter}/lab/tree/run.ipynb")
        page.get_by_text("Python 3 (ipykernel) | Idle").wait_for()
        page.get_by_role("menuitem", name="Run", exact=True).click()
        page.get_by_role("menuitem", name="Run All Cells", exact=True).click()
        plays_to_its_end(page.frame_locator("iframe[title*='10 cells']"))
        table = page.locator(".jp-OutputArea-output table").first
        assert table.locator("tbody tr").count() == 4 and "by companion" in table.inner_text()
        picture = page.locator(".jp-OutputArea-output img")
        picture.wait_for()
        assert picture.evaluate("image => image.naturalWidth") > 800


@pytest.mark.parametrize("around", ["vs code", "another site's frame"])
def test_a_run_plays_under_the_rules_of_other_notebooks(chromium, around, tmp_path):
    """In VS Code the frame lies in a page with a policy of its own, which it inherits; in Colab a cell's output is
    itself in a frame of another origin that may do little."""
    shown = show(SCENE)._repr_html_()
    if around == "vs code":
        page_text = f"<meta http-equiv=\"Content-Security-Policy\" content=\"{VS_CODE}\">{shown}"
    else:
        page_text = f"<iframe sandbox=\"allow-scripts allow-downloads\" srcdoc=\"{html.escape(shown)}\"></iframe>"
    (tmp_path / "output.html").write_text(f"<!doctype html><meta charset=\"utf-8\">{page_text}", encoding="utf-8")
    with closing(chromium.new_context(viewport=SIZE, offline=True)) as context:
        page, errors = context.new_page(), []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto((tmp_path / "output.html").as_uri())
        outer = page.frame_locator("iframe")
        plays_to_its_end(outer if around == "vs code" else outer.frame_locator("iframe"))
        assert errors == []
