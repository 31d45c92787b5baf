// The chart of the Cost tab, in the stage's place: the page says what is in it (features/cost) in templates.
(() => {
  const section = document.body.appendChild(document.createElement("section"));
  section.id = "lab-cost";
  section.setAttribute("aria-label", tr("what accuracy costs"));
  const wanted = tr("accuracy wanted"), dear = tr("runs, from cheap to dear: arrow keys go from one to the next");
  section.innerHTML = `<header></header><div class="lab-plot"><div class="lab-shade"></div>
    <div class="lab-wish" role="slider" tabindex="0" aria-orientation="vertical" aria-label="${wanted}">
    <span></span></div>
    <div class="lab-dots" role="group" aria-label="${dear}"></div>
    <div class="lab-run-tip" aria-hidden="true"></div></div>`;
  const dots = section.querySelector(".lab-dots"), tip = section.querySelector(".lab-run-tip");
  const charts = document.getElementsByClassName("lab-cost-chart");
  const heads = document.getElementsByClassName("lab-cost-says");
  let chart = null, head = null;

  function draw() {
    const held = dots.contains(document.activeElement) && document.activeElement.dataset.run;
    dots.replaceChildren(chart.content.cloneNode(true));
    tip.classList.remove("lab-shown");
    const stop = (held && dots.querySelector(`[data-run="${held}"]`)) || dots.querySelector("button");
    if (stop) stop.tabIndex = 0;
    if (held && stop) stop.focus();
    dispatchEvent(new Event("lab-cost-drawn"));
  }

  function look() {
    if (heads[0] && heads[0] !== head) {
      head = heads[0];
      section.querySelector("header").replaceChildren(head.content.cloneNode(true));
    }
    if (charts[0] && charts[0] !== chart) {
      chart = charts[0];
      draw();
    }
  }

  function say(dot) {  // its numbers beside it, towards the middle
    const [first, ...rest] = dot.getAttribute("aria-label").split("; ");
    tip.replaceChildren(makeElement("b", {}, first), ...rest.map(text => makeElement("div", {}, text)));
    tip.dataset.run = dot.dataset.run;
    tip.style.left = dot.style.left;
    tip.style.top = dot.style.top;
    tip.classList.toggle("lab-left", parseFloat(dot.style.left) > 55);
    tip.classList.toggle("lab-up", parseFloat(dot.style.top) > 55);
    tip.style.marginLeft = "";
    const beyond = section.getBoundingClientRect().left + 6 - tip.getBoundingClientRect().left;
    if (beyond > 0) tip.style.marginLeft = `${16 + beyond}px`;
    tip.classList.add("lab-shown");
  }

  for (const [event, shows] of [["pointerover", true], ["focusin", true], ["pointerout", false], ["focusout", false]])
    dots.addEventListener(event, ({target, pointerType}) => {
      const dot = pointerType !== "touch" && target.closest(".lab-dot");
      if (dot && shows && (pointerType || dot.matches(":focus-visible"))) say(dot);
      else if (pointerType !== "touch" && !shows) tip.classList.remove("lab-shown");
    });
  dots.addEventListener("keydown", event => {
    const way = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[event.key], from = event.target;
    if (!way || !from.matches(".lab-dot")) return;
    const order = [...dots.querySelectorAll(".lab-dot")];
    order.sort((one, other) => parseFloat(one.style.left) - parseFloat(other.style.left));
    const next = order[order.indexOf(from) + way];
    if (next) {
      from.tabIndex = -1;
      next.tabIndex = 0;
      next.focus();
    }
    event.preventDefault();
    event.stopPropagation();
  });
  dots.addEventListener("click", event => {  // a finger cannot rest on a dot: its first tap says the numbers
    const dot = event.target.closest(".lab-dot"), said = tip.dataset.run === dot?.dataset.run;
    if (event.pointerType !== "touch" || !dot || (said && tip.classList.contains("lab-shown"))) return;
    say(dot);
    event.stopPropagation();
  });
  document.addEventListener("click", ({target}) => {
    const picked = target.closest?.(":is(#lab-cost, .lab-cost) [data-run]");
    const pressed = target.closest?.("[data-press]")?.dataset.press;
    if (picked) typeBehind("lab-picked", `${picked.dataset.run} ${Date.now()}`);  // the time makes every click another text
    if (pressed)
      [...document.querySelectorAll("#root button")].find(one => one.innerText.trim() === pressed)?.click();
  });
  watchPage(look);
})();
