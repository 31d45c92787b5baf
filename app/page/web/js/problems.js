// The problems as buttons in the head: one of them is on the stage. Where there is no room for them the viewer's dropdown is.
(() => {
  const group = document.querySelector("#lab-head [role=radiogroup]"), buttons = new Map();
  let said = "";

  function make(problem, title) {
    const button = group.appendChild(document.createElement("button"));
    Object.assign(button, {type: "button", textContent: title});
    button.setAttribute("role", "radio");
    button.addEventListener("click", () => dispatchEvent(new CustomEvent("lab-tell", {detail: {problem}})));
    buttons.set(problem, button);
  }

  function look() {
    const data = document.querySelector("i.lab-problems")?.dataset;
    if (!data || data.said === said) return;
    const {titles, chosen} = JSON.parse(said = data.said);
    if (!buttons.size) for (const [problem, title] of Object.entries(titles)) make(problem, title);
    group.hidden = !Object.keys(titles).length;
    for (const [problem, button] of buttons) {
      button.setAttribute("aria-checked", problem === chosen);
      button.tabIndex = problem === chosen ? 0 : -1;
    }
  }

  document.addEventListener("keydown", event => {  // arrows go round, as among radio buttons: also those of the methods
    const step = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[event.key];
    const all = [...event.target.closest("#lab-head [role=radiogroup], .lab-methods")?.querySelectorAll("[role=radio]") || []];
    if (!step || !all.length) return;
    event.preventDefault();
    event.stopPropagation();
    const next = all[(all.indexOf(document.activeElement) + step + all.length) % all.length];
    next.focus();
    next.click();
  });
  new MutationObserver(look).observe(document.getElementById("root"), {childList: true, subtree: true});
})();
