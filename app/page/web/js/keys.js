// Keys do what buttons do: they click them, or tell the page. Never while somebody types, in a dialogue, or on a control
// that needs the key itself. In the presenter's view some mean something else (present.js).
(() => {
  const tell = act => tellPage({act});
  const buttons = mark => [...document.querySelectorAll(`[data-lab~=${mark}] + div button`)];
  const named = (mark, name) => buttons(mark).find(button => button.textContent.trim() === name && !button.disabled);
  const panel = name => [...document.querySelectorAll("[data-dock-region=right] button")].find(button =>
    button.textContent.trim() === name && button.offsetParent && !button.disabled);
  const playing = () => document.body.classList.contains("lab-playing");
  const slow = () => ![undefined, tr("Slow motion")].includes(buttons("lab-at-slow")[0]?.textContent.trim());
  const back = step => {
    const slider = document.querySelector(":is([data-lab~=lab-at-back], [data-lab~=lab-frames]) + div [role=slider]");
    slider?.dispatchEvent(new KeyboardEvent("keydown", {key: step < 0 ? "ArrowLeft" : "ArrowRight", bubbles: true}));
  };
  const spark = k => document.querySelectorAll("#lab-sparks .lab-spark")[k]?.click();
  const keys = new Map([
    [" ", [tr("Space"), tr("play or pause"), () => named("lab-at-run", playing() ? tr("Pause") : tr("Play"))?.click()]],
    [".", [".", tr("one time step"), () => named("lab-at-run", tr("Step"))?.click()]],
    ["r", ["R", tr("reset: from the start"), () => named("lab-at-run", tr("Reset"))?.click()]],
    ["ArrowLeft", ["←  →", tr("look back, once it has paused"), () => back(-1)]],
    ["ArrowRight", ["", "", () => back(1)]],
    ["p", ["P", tr("pin this run, or unpin it"), () => buttons("lab-at-pin")[0]?.click()]],
    ["1", ["1  2  3", tr("the questions above the stage"), () => spark(0)]],
    ["2", ["", "", () => spark(1)]],
    ["3", ["", "", () => spark(2)]],
    ["e", ["E", tr("the next estimator on the stage"), () => tell("judge")]],
    ["m", ["M", tr("magnify the error in the plot"), () => tell("magnify")]],
    ["l", ["L", tr("lessons"), () => openTab("Lessons")]],
    ["t", ["T", tr("on a slider: the error over it as a table"), null]],
    ["?", ["?", tr("this list"), () => list()]],
    ["Escape", [tr("Esc"), tr("leave the presenter’s view, slow motion, an enlarged figure"), () => {
      if (slow()) buttons("lab-at-slow")[0].click();
    }]],
  ]);
  const lab = window.lab = {keys, tell, buttons, named, panel, playing, slow, back, special: null};

  function list() {
    const dialog = document.getElementById("lab-keys"), presenting = lab.special?.();
    const rows = [...(presenting || keys).values()].filter(([name]) => name);
    dialog.querySelector("dl").replaceChildren(...rows.flatMap(([name, does]) => {
      const names = name.split("  ").map(one => makeElement("kbd", {}, one));
      return [makeElement("dt", {}, ...names), makeElement("dd", {}, does)];
    }));
    dialog.showModal();
  }

  // Whether the element that has the focus does something with this key by itself.
  function taken(element, key) {
    if (!element || element === document.body) return false;
    if (element.isContentEditable || element.matches("textarea, select, [role=option], [role=listbox]")) return true;
    if (element.matches("input")) return !element.matches("[type=checkbox], [type=radio]") || key === " ";
    if (element.matches("[role=slider], [role=tab], [role=radio]")) return key === " " || key.startsWith("Arrow");
    return element.matches("button, a, summary, [role=button], [role=switch]") && (key === " " || key === "Enter");
  }

  addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented || event.repeat && event.key === " ") return;
    const modal = document.querySelector(".mantine-Modal-content");
    if (modal && event.key === "Escape") [...modal.querySelectorAll("button")].find(b => b.textContent === tr("Close"))?.click();
    if (modal || document.querySelector("dialog[open]")) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (!event.isTrusted && key.startsWith("Arrow") || taken(document.activeElement, event.key)) return;
    const found = (lab.special?.() || keys).get(key);
    if (!found || !found[2]) return;
    event.preventDefault();
    found[2]();
  });
})();
