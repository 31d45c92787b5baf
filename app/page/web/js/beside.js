// Plain words beside a name: of a widget's label, or at the right of a folder's. And folders are buttons for keys, too.
(() => {
  const root = document.getElementById("root");
  const heads = ".mantine-Paper-root[style*='cursor: pointer']";

  // Widgets that are made anew for another scene come folded: what a visitor has opened is opened again, but where the
  // visitor was faster: a second press would close it.
  const known = new WeakSet(), open = new Map();
  root.addEventListener("click", event => {
    const head = event.target.closest(heads);
    if (head) known.add(head);
    if (head && event.isTrusted) showOpened(head);
  }, true);

  // What is opened near the panel's end would be below it.
  function showOpened(head) {
    setTimeout(() => { if (head.ariaExpanded === "true") head.parentElement.scrollIntoView({block: "nearest"}); }, 400);
  }

  const ownData = () => document.querySelector(`[data-lab~=lab-own-data] + div :is(${heads})`);
  function expanded(head) {
    changeAttribute(head, "aria-expanded", String(!head.nextElementSibling?.inert));
    if (head === ownData()) document.body.classList.toggle("lab-own-data-open", head.ariaExpanded === "true");
  }

  function unfold(head) {
    const name = head.firstChild.textContent, now = !head.nextElementSibling?.inert;
    if (!known.has(head) && open.get(name) && !now) head.click();
    else open.set(name, now);
    known.add(head);
  }

  function look() {
    openSlowMotion();
    for (const mark of document.querySelectorAll("i[data-words]")) {
      const beside = mark.parentElement.nextElementSibling;
      const name = beside?.querySelector(`label[for], ${heads}`);
      if (name && mark.dataset.words) changeAttribute(name, "data-words", mark.dataset.words);
    }
    for (const head of document.querySelectorAll(heads)) {
      changeAttribute(head, "role", "button");
      changeAttribute(head, "tabindex", "0");
      expanded(head);
      unfold(head);
    }
    followTrace();
    const foot = document.querySelector("[data-lab~=lab-estimates-foot]");
    if (foot) {
      const root = foot.parentElement;
      changeAttribute(root, "data-lab", "lab-root");
      changeAttribute(root.parentElement.parentElement, "data-lab", "lab-around");  // it hides what is beyond it, and nothing sticks in it
    }
  }

  // A particle that is traced is plotted among the numbers: they open, once for each particle.
  let particle = "";
  function followTrace() {
    const traced = document.querySelector(".lab-traced");
    const now = traced?.dataset.particle ?? "";
    if (now === particle) return;
    particle = now;
    const head = document.querySelector(`[data-lab~=lab-numbers] + div :is(${heads})`);
    if (!now || !head) return;
    for (const fold of [ownData(), head]) if (fold?.ariaExpanded === "false") fold.click();
    setTimeout(() => traced.scrollIntoView({block: "nearest"}), 700);  // it has its height by then
  }

  root.addEventListener("keydown", event => {
    if ((event.key === "Enter" || event.key === " ") && event.target.matches(heads)) {
      event.preventDefault();
      event.target.click();
      showOpened(event.target);
    }
  });
  // Slow motion opens the fold with its numbers: when the button below the stage begins it, and when a lesson does.
  let begun = null;
  function openSlowMotion() {
    const head = begun !== null && document.querySelector(".lab-slow")
      && document.querySelector(`[data-lab~=lab-slow-fold] + div :is(${heads})`);
    if (!head) return;
    if (head.getAttribute("aria-expanded") === "false") head.click();
    if (begun) head.scrollIntoView({block: "start"});
    begun = null;
  }
  root.addEventListener("click", event => {
    const button = event.target.closest("[data-lab~=lab-at-slow] + div button");
    if (button) openTab("Explore");
    if (button || event.target.closest(".lab-act[data-act=phase]")) begun = Boolean(button);
  });
  new MutationObserver(changes => {  // at once: who reads that it is folded presses it
    for (const {target} of changes) if (target.previousElementSibling?.matches(heads)) expanded(target.previousElementSibling);
  }).observe(root, {subtree: true, attributeFilter: ["inert"]});
  watchPage(look, ["inert", "data-lab"], 100);
})();
