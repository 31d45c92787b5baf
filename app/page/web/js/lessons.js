// Lessons: the list with how far one has come, which only this browser knows, answers that are chosen, what a step's text
// has one do, and figures that a click shows as large as the window.
(() => {
  const STORE = "mpm-lab/", LAST = "mpm-lab-last-lesson";
  const chosen = {};  // answers by their questions: the viewer puts html in anew
  let last = "", seen = "";

  const head = () => document.querySelector(".lab-lesson-head, .lab-shelf");
  function top() {  // of all that the viewer puts around a tab
    for (let area = head(); area; area = area.parentElement?.closest("[data-scrollarea-viewport]")) area.scrollTop = 0;
  }

  function progress(button) {  // and of how many steps; in a lesson that has been changed since one begins again
    const steps = Number(button.dataset.steps), core = button.dataset.core.split(" ").map(Number);
    try {
      const kept = JSON.parse(fromStorage(store => store.getItem(STORE + button.dataset.lesson), "null"));
      if (!kept || kept.fingerprint !== button.dataset.fingerprint) return [0, steps];
      if (!kept.core) return [kept.step, steps];
      return [kept.step > steps ? core.length + 1 : core.filter(number => number <= kept.step).length, core.length];
    } catch { return [0, steps]; }
  }

  function shelf(list) {
    if (list.dataset.filled) return;
    list.dataset.filled = "yes";
    for (const button of list.querySelectorAll(".lab-open[data-steps]")) {
      const [at, steps] = progress(button), come = button.querySelector(".lab-come");
      if (!(at > 0)) continue;
      come.textContent = at > steps ? tr("done") : tr("{at} of {steps}", {at, steps});
      button.classList.toggle("lab-done", at > steps);
      if (at > steps || button.dataset.lesson !== fromStorage(store => store.getItem(LAST), "")) continue;
      const on = makeElement("button", {type: "button", className: "lab-open lab-continue"},
        tr("Continue: {lesson}", {lesson: button.querySelector("b").textContent}));
      on.dataset.lesson = button.dataset.lesson;
      list.querySelector(".lab-go-on").append(on);
    }
  }

  function look() {
    document.querySelectorAll(".lab-shelf").forEach(shelf);
    for (const radio of document.querySelectorAll(".lab-choice input"))
      if (chosen[radio.dataset.question] === radio.value && !radio.disabled) radio.checked = true;
    const open = document.querySelector(".lab-kept")?.dataset.lesson || "";
    if (open && open !== last) fromStorage(store => store.setItem(LAST, open));
    last = open;
    const now = head()?.textContent || "";
    if (now !== seen) setTimeout(top, 150);
    seen = now;
  }

  const back = () => document.querySelectorAll(".lab-enlarge.lab-large").forEach(one => one.classList.remove("lab-large"));
  addEventListener("keydown", event => { if (event.key === "Escape") back(); });
  addEventListener("keydown", event => {  // of an answer, which the viewer passes on a moment later
    if (event.key === "Enter" && event.target.matches("[data-lab~=lab-enter] ~ div input"))
      setTimeout(() => document.querySelector("[data-lab~=lab-main] + div button:not(:disabled)")?.click(), 200);
  });
  document.addEventListener("click", event => {
    const at = selector => event.target.closest?.(selector);
    at(".lab-enlarge")?.classList.toggle("lab-large");
    if (at(".lab-open")) tellPage({open: at(".lab-open").dataset.lesson});
    const act = at(".lab-act");
    if (!act) return;
    const number = act.dataset.act;
    if (number !== "phase")  // of a phase the page ticks what it has done
      document.querySelectorAll(`.lab-act[data-act="${number}"]`).forEach(each => each.classList.add("lab-did"));
    if (number === "budget") return;  // js/budget.js hears that
    tellPage({do: [Number(act.closest("[data-step]").dataset.step), Number.isNaN(Number(number)) ? number : Number(number)]});
  });
  document.addEventListener("change", event => {
    const {question} = event.target.dataset || {};
    if (!question) return;
    chosen[question] = event.target.value;
    tellPage({choice: [question, Number(event.target.value)]});
  });
  watchPage(look, ["data-lesson"]);
})();
