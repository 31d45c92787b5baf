// A talk: what a speaker's keys and remote do in the presenter's view, and what stands on the slide.
(() => {
  const {tell, named, buttons, panel, playing, slow, back, keys} = window.lab, body = document.body;
  const presenting = () => body.classList.contains("lab-presented-view");
  const studying = () => body.classList.contains("lab-lesson-open");
  const black = document.getElementById("lab-black");

  function turn(by) {  // a lesson's step, a phase of a step, or a step of time
    if (studying()) panel(by > 0 ? tr("Next") : tr("Back"))?.click();
    else if (slow()) tell(by > 0 ? "phase" : "phase back");
    else if (by > 0) named("lab-at-run", playing() ? tr("Pause") : tr("Step"))?.click();
    else if (playing()) named("lab-at-run", tr("Pause"))?.click();
    else back(-1);
  }
  function view(name) {
    for (const other of ["alone", "cost"]) body.classList.toggle(`lab-view-${other}`, name === other);
    if (!studying() || name === "cost") openTab(name === "cost" ? "Cost" : "Explore");
  }
  const dark = on => { black.hidden = !on; };
  const usual = key => [key, keys.get(key)];
  const speaker = new Map([
    usual(" "), usual("."), usual("r"),
    ["ArrowRight", ["←  →", tr("a time step; in slow motion a phase; in a lesson its next or last slide"), () => turn(1)]],
    ["ArrowLeft", ["", "", () => turn(-1)]],
    ["PageDown", [tr("Page ↓  Page ↑"), tr("the same, on a presenter’s remote"), () => turn(1)]],
    ["PageUp", ["", "", () => turn(-1)]],
    ["m", ["M", tr("the next method"), () => tell("method")]],
    usual("e"), usual("p"),
    ["s", ["S", tr("slow motion"), () => buttons("lab-at-slow")[0]?.click()]],
    ["1", ["1", tr("stage and error over time"), () => view("")]],
    ["2", ["2", tr("the stage alone, as wide as the window"), () => view("alone")]],
    ["3", ["3", tr("what it costs"), () => view("cost")]],
    ["l", ["L", tr("lessons, as slides"), () => { view(""); openTab("Lessons"); }]],
    ["q", ["Q", tr("a code for phones"), () => tell("code")]],
    ["b", ["B", tr("black, and back"), () => dark(black.hidden)]],
    usual("?"), ["Escape", [tr("Esc"), tr("leave"), null]],
  ]);
  window.lab.special = () => presenting() ? speaker : null;

  addEventListener("keydown", event => {  // any key ends the black, and does nothing else
    if (black.hidden) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    dark(false);
  }, true);
  black.addEventListener("click", () => dark(false));

  let asked = new URLSearchParams(location.search).has("present");
  if (asked) tell("present");
  addEventListener("lab-asked", () => { if (asked) { asked = false; tell("present"); } });

  let was = false;
  watchPage(() => {
    const now = presenting();
    body.classList.toggle("lab-slowly", now && slow());
    if (now && !was) {
      document.activeElement?.blur();  // of the button that ends it: a space is for the run
      if (studying()) openTab("Lessons");
    }
    if (!now && was) { dark(false); body.classList.remove("lab-view-alone", "lab-view-cost"); }
    was = now;
  });
})();
