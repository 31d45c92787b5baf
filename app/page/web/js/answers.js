// What is said under the control that was changed last: that its wish is being compiled, and for how long so far, or why it
// cannot be met. And who is done with typing says so: Enter, or going elsewhere.
(() => {
  const root = document.getElementById("root");
  let shown = null, key = "", since = 0;

  const row = id => {  // of a number of any size it is the text's, which stands below its slider's
    const own = document.getElementById(id)?.closest(".mantine-Flex-root:has(label)")?.parentElement;
    return own?.matches("[data-lab~=lab-logarithmic] + div") ? own.nextElementSibling.nextElementSibling : own;
  };

  function say() {
    const data = document.querySelector("i.lab-answer")?.dataset, place = data && row(data.of);
    if (shown && shown !== place) { delete shown.dataset.answer; delete shown.dataset.answerKind; }
    shown = place || null;
    if (!shown) { key = ""; return; }
    if (key !== data.of + data.kind) [key, since] = [data.of + data.kind, performance.now()];
    const seconds = Math.floor((performance.now() - since) / 1000);
    const text = data.kind === "compiling" && seconds > 0 ? `${data.says} ${seconds} s` : data.says;
    if (shown.dataset.answer !== text) Object.assign(shown.dataset, {answer: text, answerKind: data.kind});
  }

  setInterval(() => key && say(), 500);
  let waiting = false;
  new MutationObserver(() => {
    if (waiting) return;
    waiting = true;
    setTimeout(() => { waiting = false; say(); }, 60);
  }).observe(root, {childList: true, subtree: true});

  const done = event => {
    const typed = event.target.closest?.("[data-lab~=lab-typed] + div input");
    if (typed && typed.dataset.typed === "yes") {
      typed.dataset.typed = "";
      dispatchEvent(new CustomEvent("lab-tell", {detail: {entered: typed.id}}));
    }
  };
  root.addEventListener("input", event => {
    if (event.target.closest("[data-lab~=lab-typed] + div")) event.target.dataset.typed = "yes";
  });
  root.addEventListener("keydown", event => event.key === "Enter" && done(event));
  root.addEventListener("focusout", done);
})();
