// Who made this error? The line below the judges' cards and its bar; a press on it, in a lesson, or on an answer's "Why?" asks for
// the whole budget, opens its fold and goes there.
// What opens makes room only when the page has it: so it is looked for a while. A chart that has to be waited for is gone
// to when it comes, if the visitor has not gone elsewhere meanwhile.
(() => {
  const ROOM = 150, PATIENCE = 20, LATE = 200;  // milliseconds between two looks, and how many
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  const head = () => document.querySelector("[data-lab~=lab-budget] + div .mantine-Paper-root[style*='cursor: pointer']");

  let said = null, filled = null;
  function fill() {
    const data = document.querySelector("i.lab-parts")?.dataset.said || "", line = document.querySelector(".lab-error-causes");
    if (!line || (data === said && line === filled)) return;
    [said, filled] = [data, line];
    line.hidden = !data;
    if (!data) return;
    const {says, parts} = JSON.parse(data), named = says.split(" · "), text = line.querySelector("small");
    do text.replaceChildren(...named.join(" · ").split(/([\d−]+ %)/).map((text, k) =>
      k % 2 ? makeElement("b", {}, text) : text));
    while (line.scrollWidth > line.clientWidth && named.length > 1 && named.pop());  // as many causes as there is room for
    line.querySelector("i").replaceChildren(...parts.filter(([, share]) => share > 0).map(([colour, share]) =>
      makeElement("i", {style: `flex: ${share}; background: var(--${colour})`})));
    line.classList.toggle("lab-no-parts", !parts.length);
  }
  watchPage(fill);

  const show = (element, block) => element.scrollIntoView({block, behavior: still.matches ? "auto" : "smooth"});
  function wait(found, act, left = PATIENCE) {
    const element = found(left);
    if (element) act(element); else if (left) setTimeout(() => wait(found, act, left - 1), ROOM);
  }

  // Until the visitor scrolls, presses or types: what asks later is told no.
  function whileStill(act) {
    const moved = new AbortController(), options = {signal: moved.signal, capture: true, passive: true};
    for (const kind of ["wheel", "pointerdown", "touchmove", "keydown"]) addEventListener(kind, () => moved.abort(), options);
    act(() => !moved.signal.aborted);
  }

  document.addEventListener("click", event => {
    if (event.target.closest(".lab-error-causes, .lab-why-so, .lab-act[data-act=budget]")) {
      tellPage({budget: true});
      let opened = false;  // once: a busy page is slow to open it, and another press would close it again
      let height = 0;
      const drawn = () => {  // and not growing any more: one goes no further than there is room
        const fold = head(), before = height;
        height = fold?.parentElement.querySelector(".lab-budget-chart figure") ? fold.parentElement.offsetHeight : 0;
        return height && height === before ? fold : null;
      };
      wait(left => {
        const fold = head();
        if (!opened && fold?.getAttribute("aria-expanded") === "false") fold.click();
        opened ||= Boolean(fold);
        return drawn() || (left ? null : fold);
      }, fold => {
        show(fold, "start");
        if (!height) whileStill(later => wait(() => later() && drawn(), found => show(found, "start"), LATE));
      });
    }
    if (event.target.closest("[data-lab~=lab-budget] + div button"))  // what has become of the error is below what grows
      wait(() => document.querySelector(".lab-outcome"), outcome => show(outcome, "end"));
  });
})();
