// What is written on the stage: labels over the canvas, at places in parts of its box. Python says them once for each change;
// where they are on the screen follows from the style alone, so a window that is resized needs no server.
(() => {
  const stage = document.getElementById("lab-stage"), drawn = new Map();
  let said = "", high = 0;

  // Widgets stand where the labels would that say what they are set to: to the gutter, or to a place of the stage.
  const LAID = {"/estimate-by": "estimator", "/colours/quantity": "quantity"};
  // Where nobody judges the run, somebody is offered.
  const NOBODY = tr("no estimator is chosen"), JUDGE = "companion";
  function offer() {
    const button = Object.assign(document.createElement("button"), {className: "lab-offer", textContent: tr("Switch on {judge}", {judge: JUDGE})});
    button.addEventListener("click", () => dispatchEvent(new CustomEvent("lab-tell", {detail: {judge: JUDGE}})));
    return button;
  }

  const UP = {top: "0px", center: "50%", bottom: "100%"}, ASIDE = {left: "0px", center: "50%", right: "100%"};
  function lay(widget, label, vertical, horizontal, element) {
    const left = label.role === "gutter" ? "var(--pad)" : `calc(var(--stage-left) + (${1.03 * label.x} - 0.015) * var(--u))`;
    const top = `calc(var(--stage-top) + ${label.y} * var(--lab-high) * var(--u))`;
    element.classList.add("lab-laid", `lab-under-${widget}`);
    for (const [name, value] of [["left", left], ["top", top], ["up", `-${UP[vertical]}`], ["aside", `-${ASIDE[horizontal]}`]])
      document.body.style.setProperty(`--${widget}-${name}`, value);
  }

  function put(label) {
    let element = drawn.get(label.name);
    if (!element) {
      element = stage.appendChild(document.createElement("span"));
      drawn.set(label.name, element);
    }
    const [vertical, horizontal] = label.anchor.split("-"), key = JSON.stringify(label);
    if (element.dataset.key === key) return;
    element.dataset.key = key;
    element.className = `lab-label lab-role-${label.role} lab-tone-${label.tone || "plain"} lab-${vertical} lab-to-${horizontal}`
      + (label.bold ? " lab-bold" : "") + (label.sign ? ` lab-sign-${label.sign}` : "");
    element.textContent = label.text;
    if (label.text === NOBODY && label.name.endsWith("/estimate-silence")) element.append(offer());
    const place = Object.keys(LAID).find(end => label.name.endsWith(end));
    if (place) lay(LAID[place], label, vertical, horizontal, element);
    element.style.left = `${100 * label.x}%`;
    element.style.top = `${100 * label.y}%`;
    element.style.setProperty("--size", label.size || 1);
  }

  function look() {
    const data = document.querySelector("i.lab-stage")?.dataset;
    if (!data || data.said === said) return;
    said = data.said;
    const {labels, high: height, box} = JSON.parse(said), names = new Set(labels.map(label => label.name));
    for (const [name, element] of drawn) if (!names.has(name)) { element.remove(); drawn.delete(name); }
    labels.forEach(put);
    for (const widget of Object.values(LAID))  // what changes nothing that is shown goes
      document.body.classList.toggle(`lab-no-${widget}`, !stage.querySelector(`.lab-under-${widget}`));
    if (height !== high) document.body.style.setProperty("--lab-high", high = height);
    dispatchEvent(new CustomEvent("lab-laid", {detail: box}));
  }

  new MutationObserver(look).observe(document.getElementById("root"), {childList: true, subtree: true});
})();
