// What the page says of itself comes and goes many times a second. If style sheets looked for it with :has(), the browser
// would find the style of everything anew each time: so the viewer's elements are called, in data-lab, by what is in them.
(() => {
  // What stands above the rest comes before it for the keyboard, too.
  document.getElementById("root").before(...["lab-head", "lab-verdict"].map(name => document.getElementById(name)));
  const all = selector => document.querySelectorAll(selector);
  const call = (element, name) => { if (element && element.dataset.lab !== name) element.dataset.lab = name; };
  const is = (name, selector) => document.body.classList.toggle(name, document.querySelector(selector) !== null);
  const presenter = () => document.querySelector("[data-lab~=lab-present] + div button");

  addEventListener("keydown", event => {
    if (event.key === "Escape" && document.querySelector("i.lab-presenting")
        && !document.querySelector("dialog[open], .mantine-Modal-content")) presenter().click();
  });
  watchPage(() => {
    for (const mark of all("i[class^=lab-], .lab-heading, .lab-readout, .lab-time")) call(mark.parentElement, mark.className);
    is("lab-to-see", ".lab-says, .lab-refused, .lab-trouble");
    is("lab-presented-view", "i.lab-presenting");
    is("lab-lesson-open", "i.lab-studying");
    is("lab-stage-closed", ".lab-curtain");
    is("lab-file-on-stage", "i.lab-file-shown");
  });
})();
