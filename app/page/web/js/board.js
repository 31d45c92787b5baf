// The board of a class, on a page that was opened with the board's code: it covers all else, or leaves the stage to be seen.
// What is on it the page says in a template (features/board); what is pressed goes with the turn that it was meant for.
(() => {
  const SILENT = 4000;  // milliseconds without an answer to what was pressed
  const boards = document.getElementsByClassName("lab-board"), body = document.body;
  let section = null, said = null, waits = null, buttons = {};
  const covers = () => body.classList.contains("lab-board-view");
  function tell(what, turn = Number(said.dataset.turn)) {
    tellPage({board: [what, turn]});
    if (what !== "save") waits ??= setTimeout(() => { section.querySelector(".lab-silent").hidden = false; }, SILENT);
  }
  const next = () => said.dataset.next && tell("next");
  const back = () => said.dataset.back && tell("back");
  const turn = () => tell("stage", covers() ? 1 : 0);
  const save = () => tell("save");
  const scroll = by => section.querySelector(".lab-slide [tabindex]")?.scrollBy({top: by * 0.3 * innerHeight});
  const nothing = () => {};  // of keys that mean something on the page below
  const keys = new Map([
    ["ArrowRight", [tr("→  Page ↓  Space"), tr("the next action (the main button)"), next]],
    ["PageDown", ["", "", next]], [" ", ["", "", next]],
    ["ArrowLeft", [tr("←  Page ↑"), tr("look back; all steps stay open"), back]],
    ["PageUp", ["", "", back]],
    ["ArrowDown", ["↓  ↑", tr("scroll long texts"), () => scroll(1)]],
    ["ArrowUp", ["", "", () => scroll(-1)]],
    ["v", ["V", tr("the stage, and back to the board"), turn]],
    ["?", ["?", tr("this list"), null]],
    ...["Escape", ".", "r", "p", "1", "2", "3", "e", "m", "l"].map(key => [key, ["", "", nothing]]),
  ]);

  function build() {
    section = body.appendChild(document.createElement("section"));
    section.id = "lab-board";
    section.setAttribute("aria-label", tr("the board"));
    section.innerHTML = "<div class='lab-slide'></div><p class='lab-silent' role='alert' hidden></p>"
      + "<nav></nav>";
    section.querySelector(".lab-silent").textContent = tr("The lab does not respond. The board continues when it does.");
    const nav = section.querySelector("nav");
    nav.setAttribute("aria-label", tr("what the board shows"));
    for (const [name, label, act] of [["back", tr("← Look back"), back], ["save", tr("Save"), save], ["stage", "", turn], ["next", "", next]]) {
      buttons[name] = nav.appendChild(makeElement("button", {type: "button", className: `lab-board-${name}`}, label));
      buttons[name].addEventListener("click", act);
    }
    buttons.save.title = tr("a file of what was answered, without names");
    const usual = window.lab.special, all = window.lab.keys;
    keys.set("?", all.get("?"));
    window.lab.special = () => covers() ? keys : new Map([...(usual() || all), ["v", keys.get("v")]]);
    addEventListener("keydown", event => {  // a key that is held down opens one step, not all of them
      if (covers() && event.repeat && keys.has(event.key)) { event.preventDefault(); event.stopImmediatePropagation(); }
    }, true);
  }

  function set(button, text, on) {
    changeText(button, text);
    if (button.disabled === on) button.disabled = !on;
  }

  function look() {
    const now = boards[0];
    if (now === said || !now) return;
    said = now;
    if (!section) build();
    clearTimeout(waits);
    waits = null;
    section.querySelector(".lab-silent").hidden = true;
    const on = said.dataset.covers === "yes", slide = section.querySelector(".lab-slide");
    const top = slide.querySelector("[tabindex]")?.scrollTop || 0, where = slide.querySelector("h2")?.textContent;
    slide.replaceChildren(said.content.cloneNode(true));
    if (slide.querySelector("h2")?.textContent === where && slide.querySelector("[tabindex]")) slide.querySelector("[tabindex]").scrollTop = top;
    set(buttons.back, tr("← Look back"), said.dataset.back === "yes");
    set(buttons.stage, on ? tr("The stage (V)") : tr("Back to the board (V)"), true);
    set(buttons.next, said.dataset.next ? `${said.dataset.next} →` : tr("This is the end"), said.dataset.next !== "");
    body.classList.toggle("lab-board-view", on);
    for (const other of body.children)
      if (other !== section && !other.matches("dialog, script, style")) other.inert = on;
  }
  watchPage(look);
})();
