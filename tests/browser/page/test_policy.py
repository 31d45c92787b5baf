"""What the page may do, as a real browser sees it: its own scripts and nothing else."""

from tests.browser.driving import until

HEARD = """window.violations = [];
document.addEventListener("securitypolicyviolation", event => violations.push(event.effectiveDirective));"""
INTRUDER = """() => {
  const room = document.body.appendChild(document.createElement("div"));
  room.innerHTML = "<img src='data:,x' onerror='window.intruded = 1'>";
  const script = room.appendChild(document.createElement("script"));
  script.textContent = "window.intruded = 2";
  fetch("http://127.0.0.1:9/").catch(() => {});
}"""
ALLOWED = {"script-src-attr", "script-src-elem", "connect-src"}


def test_page_runs_its_own_scripts_only(chromium, server):
    """Of its own nothing is refused, workers, fonts and pictures among them; of what is put into it everything is."""
    page = chromium.new_page()
    page.add_init_script(HEARD)
    page.goto(f"{server[0]}/?fixedDpr=0.5")
    until(page.locator(".lab-readout", has_text="periods").count, "the first numbers")
    assert page.evaluate("violations") == []
    page.evaluate(INTRUDER)
    until(lambda: set(page.evaluate("violations")) == ALLOWED, "all of it refused")
    assert page.evaluate("window.intruded") is None
    page.close()
