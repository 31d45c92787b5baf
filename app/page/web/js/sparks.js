// The buttons under the headline (page/panels/suggestions.py): real ones, in their order, and an answer. All of it is text.
(() => {
  const ICONS = {
    halve: "M3 6h18v12H3zM12 6v12M7.5 6v12M16.5 6v12", tile: "M3 4h7v7H3zM13 4h8v7h-8zM3 14h7v6H3zM13 14h8v6h-8z", cross: "M12 3v3m0 3v3m0 3v3m0 3v0M4 12h14M14 8l4 4-4 4",
    break: "M3 16c3-8 5-8 7-3M21 8c-3 9-5 8-6 4M13 5l-2 5 3 2-2 6", back: "M5 12h14M11 6l-6 6 6 6",
    filter: "M4 5h16l-6 8v6l-4-2v-4z", judge: "M12 4v16M5 8h14M5 8l-3 6h6zM19 8l-3 6h6zM8 20h8",
    stairs: "M3 19h4v-4h4v-4h4V7h6", done: "M5 12.5l4.5 4.5L19 7.5"};
  const box = document.getElementById("lab-sparks"), aloud = document.getElementById("lab-aloud");
  let shown = null, answered = "";

  function icon(name) {
    const made = document.createElementNS("http://www.w3.org/2000/svg", "svg"), path = made.appendChild(
      document.createElementNS("http://www.w3.org/2000/svg", "path"));
    made.setAttribute("viewBox", "0 0 24 24");
    made.setAttribute("aria-hidden", "true");
    path.setAttribute("d", ICONS[name]);
    return made;
  }

  function button(card) {
    const made = makeElement("button", {className: card.done ? "lab-spark lab-done" : "lab-spark"}, icon(card.icon),
      makeElement("span", {}, makeElement("b", {}, card.title), makeElement("small", {}, card.hint)));
    if (card.done) made.append(makeElement("span", {className: "lab-tick"}, icon("done")));
    made.dataset.key = card.key;
    // One that is off keeps its place for the keyboard, and says why it is.
    if (card.off) made.setAttribute("aria-disabled", "true");
    else made.addEventListener("click", () => tellPage({spark: card.key}));
    return made;
  }

  function answerBox(text, hint, why) {
    const first = makeElement("b", {}, text);
    if (why) {  // js/budget.js opens the error budget
      const asked = makeElement("button", {type: "button", className: "lab-why-so"}, why);
      asked.addEventListener("click", () => openTab("Explore"));
      first.append(" ", asked);
    }
    return makeElement("div", {className: "lab-answer"}, first, makeElement("small", {}, hint));
  }

  function look() {
    const said = document.querySelector(".lab-sparks")?.dataset.sparks || "";
    if (said === shown) return;
    shown = said;
    const focused = box.contains(document.activeElement), key = document.activeElement.dataset?.key;
    if (!said) return box.replaceChildren();
    const {label, answer, cards} = JSON.parse(said), made = [makeElement("span", {className: "lab-question"}, label)];
    if (answer) made.push(answerBox(...answer));
    const buttons = cards.map(button);
    box.classList.toggle("lab-pills", !answer && cards.some(card => card.done));
    box.replaceChildren(...made, ...buttons);
    if (focused) (buttons.find(one => one.dataset.key === key) || buttons[0])?.focus({preventScroll: true});
    const spoken = answer ? answer.join(" ") : "";
    if (spoken && spoken !== answered) aloud.textContent = spoken;
    answered = spoken;
  }
  watchPage(look);
})();
