// Fills the cards of the judges; a click puts a card's errors on the stage. And a click on the picture of a method takes it.
(() => {
  const root = document.getElementById("root");
  const write = (element, text) => { if (element) changeText(element, text); };
  let said = "", filled = null, takesFocus = false;

  function look() {
    if (takesFocus && document.activeElement === document.body)  // the buttons of the methods were made anew
      document.querySelector(".lab-methods [aria-checked=true]")?.focus({preventScroll: true});
    const data = document.querySelector("i.lab-judged")?.dataset.said, first = document.querySelector(".lab-judge");
    if (!data || (data === said && first === filled)) return;
    [said, filled] = [data, first];
    const {problem, stage, judges} = JSON.parse(data), others = [];
    for (const card of document.querySelectorAll(".lab-judge")) {
      const row = card.parentElement.previousElementSibling, runs = row.querySelector("input")?.checked;
      const judge = card.dataset.problem === problem && runs && judges[card.dataset.judge];
      if (runs) delete row.dataset.off; else others.push(card.dataset.judge);
      if (!runs) row.dataset.off = "yes";
      card.classList.toggle("lab-off", !runs);
      card.classList.toggle("lab-silent", Boolean(judge?.says));
      card.classList.toggle("lab-on-stage", card.dataset.judge === stage && Boolean(judge));
      write(card.querySelector(".lab-finds strong"), judge?.finds || "");
      write(card.querySelector(".lab-trust"), judge?.says || judge?.trust || card.dataset.idea);
    }
    const ask = document.querySelector(".lab-ask");
    write(ask?.querySelector("span"), others.join(", ").replaceAll("-", "\u2011"));  // no line ends within a name
    if (ask) ask.hidden = !others.length;
    ask?.setAttribute("aria-expanded", document.body.classList.contains("lab-judges-open"));
  }

  root.addEventListener("change", event => {
    if (event.target.closest("[data-lab~=lab-switch] + div")) { said = ""; look(); }
  });
  root.addEventListener("click", event => {
    const card = event.target.closest(".lab-judge"), method = event.target.closest(".lab-method");
    if (card) tellPage({judge: card.dataset.judge});
    if (method) tellPage({method: method.dataset.method});
    takesFocus = Boolean(method);
    const ask = event.target.closest(".lab-ask");
    ask?.setAttribute("aria-expanded", document.body.classList.toggle("lab-judges-open"));
  });
  watchPage(look);
})();
