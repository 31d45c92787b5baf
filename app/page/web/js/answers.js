// What is said under the control that was changed last: that its wish is being compiled, and for how long so far, or why it
// cannot be met. And who is done with typing says so: Enter, or going elsewhere.
(() => {
  const root = document.getElementById("root");
  let shown = [], key = "", since = 0;

  // Of a number of any size the row is the text's, which stands below its slider's; of a judge it is the card.
  function places(id) {
    const input = document.getElementById(id);
    if (!input) return [document.querySelector(".lab-methods")?.parentElement, null];  // the methods are html, without an id
    const flex = input.closest(".mantine-Flex-root:has(label)"), own = flex?.parentElement;
    if (!own) return [null, null];
    if (own.matches("[data-lab~=lab-switch] + div")) return Array(2).fill(own.nextElementSibling.querySelector(".lab-judge"));
    const below = own.matches("[data-lab~=lab-logarithmic] + div") ? own.nextElementSibling.nextElementSibling : own;
    return [below, flex.querySelector("label")];
  }

  function write(element, name, text) {
    if (!element) return;
    shown.push([element, name]);
    if (element.dataset[name] !== text) element.dataset[name] = text;
  }

  function say() {
    const data = document.querySelector("i.lab-answer")?.dataset, before = shown;
    shown = [];
    if (data) {
      if (key !== data.of + data.kind) [key, since] = [data.of + data.kind, performance.now()];
      const seconds = Math.floor((performance.now() - since) / 1000), [below, label] = places(data.of);
      if (data.kind === "compiling") {
        write(label, "waits", seconds > 0 ? `${data.says} ${seconds} s` : data.says);
        write(below, "waiting", "yes");
      } else write(below, "answer", data.says);
    } else key = "";
    for (const [element, name] of before)
      if (!shown.some(other => other[0] === element && other[1] === name)) delete element.dataset[name];
  }

  setInterval(() => key && say(), 500);
  watchPage(say, undefined, 60);

  const TYPED = "[data-lab~=lab-typed] + div, [data-lab~=lab-formula] + div";
  const done = event => {
    const typed = event.target.closest?.(`:is(${TYPED}) input`);
    const name = typed?.closest(".mantine-Flex-root").querySelector("label");
    if (typed && typed.dataset.typed === "yes") {
      typed.dataset.typed = "";
      tellPage({entered: [name.htmlFor, typed.value]});
    }
  };
  root.addEventListener("input", event => {
    if (event.target.closest(TYPED)) event.target.dataset.typed = "yes";
  });
  root.addEventListener("keydown", event => event.key === "Enter" && done(event));
  root.addEventListener("focusout", done);
})();
