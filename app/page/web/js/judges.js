// Fills the cards of the judges; a click on a name puts its errors on the stage. And a click on a picture of a method takes it.
(() => {
  const root = document.getElementById("root");
  const write = (element, text) => { if (element && element.textContent !== text) element.textContent = text; };
  let said = "", filled = null, takesFocus = false;

  function look() {
    if (takesFocus && document.activeElement === document.body)  // the buttons of the methods were made anew
      document.querySelector(".lab-methods [aria-checked=true]")?.focus({preventScroll: true});
    const data = document.querySelector("i.lab-judged")?.dataset.said, first = document.querySelector(".lab-judge");
    if (!data || (data === said && first === filled)) return;
    [said, filled] = [data, first];
    const {problem, true: norm, stage, judges, known} = JSON.parse(data);
    const truth = document.querySelector(".lab-judge-true");
    write(truth?.querySelector("strong"), norm);
    truth?.classList.toggle("lab-unknown", !known);
    for (const card of document.querySelectorAll(".lab-judge")) {
      const box = card.parentElement.previousElementSibling.querySelector("input"), gauge = card.querySelector(".lab-gauge");
      const judge = card.dataset.problem === problem && box?.checked && judges[card.dataset.judge];
      card.classList.toggle("lab-off", !box?.checked);
      card.classList.toggle("lab-silent", Boolean(judge?.says));
      card.classList.toggle("lab-on-stage", card.dataset.judge === stage && Boolean(judge));
      write(card.querySelector(".lab-index strong"), judge?.index || "");
      write(card.querySelector(".lab-why"), judge?.says || "");
      write(card.querySelector(".lab-trust"), judge?.trust || "");
      if (judge?.at != null) gauge.style.setProperty("--at", judge.at); else gauge.removeAttribute("style");
    }
  }

  root.addEventListener("change", event => {
    if (event.target.closest("[data-lab~=lab-switch] + div")) { said = ""; look(); }
  });
  root.addEventListener("click", event => {
    const tell = detail => dispatchEvent(new CustomEvent("lab-tell", {detail}));
    const name = event.target.closest(".lab-judge-name"), method = event.target.closest(".lab-method");
    if (name) tell({judge: name.closest(".lab-judge").dataset.judge});
    if (method) tell({method: method.dataset.method});
    takesFocus = Boolean(method);
  });
  new MutationObserver(look).observe(root, {childList: true, subtree: true});
})();
