// A lesson for who hears it or has no mouse: the focus goes on with the step, and what is said of an answer is read out.
(() => {
  const PATIENCE = 4000;  // ms in which a step comes that has been asked for
  const told = document.getElementById("lab-told"), find = selector => document.querySelector(selector);
  const words = selector => find(selector)?.textContent || "";
  let pressed = -PATIENCE, before = {}, at = null;  // when, what stood there then, and what has been given the focus
  let step = "";

  document.addEventListener("click", () => {
    pressed = performance.now();
    before = {step: words(".lab-lesson-head"), said: words(".lab-recorded")};
  }, true);

  const lost = () => !document.activeElement || document.activeElement === document.body;

  // Where one goes on reading: what is said of a prediction, or the heading of a step; null while that is yet to come.
  function place() {
    if (words(".lab-lesson-head") === before.step && find(".lab-recorded")) return find(".lab-recorded");
    return find(".lab-segments :is(.lab-now, .lab-past)") ? find(".lab-lesson h2") : find(".lab-lesson-head");
  }

  // Only where the viewer has removed what had it: by a step that was asked for, or by words that came later.
  function follow() {
    if (!lost() || !find(".lab-lesson-head")) return;
    if (at?.isConnected) at = null;  // the reader has left it
    else if (performance.now() - pressed > PATIENCE && !at) return;
    else if ((at = place())) {
      at.tabIndex = -1;
      at.focus({preventScroll: true});
    }
  }

  function look() {
    const said = words(".lab-recorded"), now = words(".lab-lesson-head");
    if (now !== step) told.textContent = "";  // what was said of another step's answer, which may be the same
    step = now;
    if (said && said !== before.said && now === before.step) {
      before.said = said;
      told.replaceChildren(...find(".lab-recorded").cloneNode(true).childNodes);  // words keep their languages
    }
    if (lost()) setTimeout(follow, 100);
  }
  new MutationObserver(look).observe(document.getElementById("root"), {childList: true, subtree: true, characterData: true});
})();
