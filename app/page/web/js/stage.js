// What is written on the stage: labels over the canvas, at places in parts of its box. Python says them once for each change;
// where they are on the screen follows from the style alone, so a window that is resized needs no server.
(() => {
  const stage = document.getElementById("lab-stage"), drawn = new Map();
  let said = "", high = 0;

  // Widgets stand where the labels would that say what they are set to: to the gutter, or to a place of the stage.
  const LAID = {"/estimate-by": "estimator", "/colours/quantity": "quantity"};

  // What the run is compared with is chosen within the second run's title, or in the gutter of a run that is alone.
  const choice = makeElement("select", {className: "lab-compare", ariaLabel: tr("Compare with")});
  choice.addEventListener("change", () => tellPage({compare: choice.value}));
  let offered = "";
  function offerChoices() {
    const data = document.querySelector("i.lab-compared")?.dataset.said;
    if (!data || data === offered) return;
    const {chosen, choices} = JSON.parse(offered = data);
    choice.replaceChildren(...choices.map(([value, text]) => new Option(text, value, false, value === chosen)));
  }
  const JUDGE = "companion", OFFERS = {
    unjudged: text => {  // nobody judges the run: somebody is offered
      const button = makeElement("button", {className: "lab-offer"}, tr("Switch on {judge}", {judge: JUDGE}));
      button.addEventListener("click", () => tellPage({judge: JUDGE}));
      return [makeElement("span", {}, text), button];
    },
    compared: text => [makeElement("span", {}, text), choice],
    duration: text => {
      const button = makeElement("button", {title: tr("time of this run so far, at the speed measured on this machine; opens Cost")}, text);
      button.addEventListener("click", () => openTab("Cost"));
      return [button];
    }};
  function writeSpans(element, spans) {
    const kinds = spans.map(([kind]) => kind).join();
    if (element.dataset.kinds !== kinds) {
      element.dataset.kinds = kinds;
      const focused = element.contains(document.activeElement) && document.activeElement.tagName;
      element.replaceChildren(...spans.map(([kind, text]) =>
        makeElement("span", {className: kind && `lab-part-${kind}`}, ...OFFERS[kind]?.(text) || [text])));
      if (focused) element.querySelector(focused)?.focus();
    }
    spans.forEach(([kind, text], k) => {
      changeText(OFFERS[kind] ? element.children[k].firstChild : element.children[k], text);
    });
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
    if (label.spans) writeSpans(element, label.spans); else element.textContent = label.text;
    if (label.name.startsWith("/colours/tick")) Object.assign(element, {title: tr("in per cent, or in the unit: click"),
      onclick: () => tellPage({scale: true})});
    element.classList.toggle("lab-of-scale", Boolean(element.onclick));
    const place = Object.keys(LAID).find(end => label.name.endsWith(end));
    if (place) lay(LAID[place], label, vertical, horizontal, element);
    element.style.left = `${100 * label.x}%`;
    element.style.top = `${100 * label.y}%`;
    element.style.setProperty("--size", label.size || 1);
  }

  function look() {
    offerChoices();
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

  watchPage(look);
})();
