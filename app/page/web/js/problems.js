// The problems as buttons in the head, called by the last word of their titles: one of them is on the stage. The last button has
// a menu for what is one's own. Where there is no room for them it is the only one, and has all in its menu.
(() => {
  const group = document.querySelector("#lab-head [role=radiogroup]"), buttons = new Map();
  const own = radio(tr("Your own")), narrow = matchMedia("(max-width: 1239px)");
  const menu = makeElement("div", {role: "menu", ariaLabel: tr("Your own"), hidden: true});
  let said = "";

  function radio(text) {
    return makeElement("button", {type: "button", role: "radio"}, text);
  }

  function make(problem, title) {
    const word = title.split(" ").at(-1), button = group.insertBefore(radio(word[0].toUpperCase() + word.slice(1)), own);
    const choose = () => tellPage({problem});
    button.ariaLabel = title;
    button.addEventListener("click", choose);
    buttons.set(problem, button);
    menu.insertBefore(item(button.textContent, title, choose), typedMotion).className = "lab-problem";
  }

  function item(title, hint, act, within = menu) {
    const button = makeElement("button", {type: "button", role: "menuitem"}, makeElement("b", {}, title));
    if (hint) button.append(makeElement("small", {}, hint));
    button.addEventListener("click", () => { open(false); act(); });
    return within.appendChild(button);
  }

  const items = () => [...menu.querySelectorAll("button")].filter(one => one.checkVisibility());
  function open(on) {
    menu.hidden = !on;
    if (on) items()[0].focus();
  }

  // The formula's field is in a fold, of a problem that has one.
  function toFormula(left = 40) {
    const formula = document.querySelector("[data-lab~=lab-formula] + div input");
    if (formula?.offsetParent) return formula.focus();
    const fold = [...document.querySelectorAll("[aria-expanded=false]")].find(head =>
      head.firstChild?.textContent === tr("Physics and method"));
    if (left % 8 === 0) fold?.click();
    if (left) setTimeout(() => toFormula(left - 1), 150);
  }

  own.setAttribute("aria-haspopup", "menu");
  own.addEventListener("click", () => open(menu.hidden));
  const typedMotion = item(tr("A motion, typed"), tr("a formula of the displacement u(X, t)"), () => {
    openTab("Explore");
    if (!document.querySelector("[data-lab~=lab-formula]")) tellPage({problem: "bar"});
    toFormula();
  });
  item(tr("A body, from a file"), tr("elastic; its exact motion nobody knows: drop a .toml anywhere, or take one of ours"), () => {}).dataset.own = "file";
  const library = menu.appendChild(makeElement("div", {className: "lab-bodies", role: "group", ariaLabel: tr("bodies that come along")}));
  item(tr("Particles from a file"), tr("of any code; or drop the file anywhere"), () => {}).dataset.own = "file";  // drop.js asks for it
  group.append(own);
  group.after(menu);
  menu.addEventListener("keydown", event => {
    const step = {ArrowDown: 1, ArrowUp: -1}[event.key], all = items();
    if (event.key === "Escape") { open(false); own.focus(); }
    if (step) all[(all.indexOf(document.activeElement) + step + all.length) % all.length].focus();
    if (!step && event.key !== "Escape") return;
    event.preventDefault();
    event.stopPropagation();
  });
  document.addEventListener("pointerdown", event => {
    if (!menu.hidden && !event.target.closest("#lab-head [role=menu]") && !own.contains(event.target)) open(false);
  });

  function look() {
    const data = document.querySelector("i.lab-problems")?.dataset;
    if (!data || data.said === said) return;
    const {titles, chosen, own: named, bodies} = JSON.parse(said = data.said);
    if (!buttons.size) for (const [problem, title] of Object.entries(titles)) make(problem, title);
    if (!library.childElementCount) for (const [body, title] of Object.entries(bodies))
      item(title, "", () => tellPage({body}), library);
    group.hidden = !Object.keys(titles).length;
    own.textContent = named ? named : narrow.matches ? buttons.get(chosen)?.textContent : tr("Your own");
    for (const [problem, button] of [...buttons, ["", own]]) {
      const checked = problem === (named ? "" : chosen) || narrow.matches && button === own;
      button.setAttribute("aria-checked", checked);
      button.tabIndex = checked ? 0 : -1;
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
    if (next !== own) next.click();
  });
  narrow.addEventListener("change", () => { said = ""; look(); });
  watchPage(look);
})();
