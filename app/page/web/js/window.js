// Tells the page how much room there is: for the stage and the plot over time, in the window's own pixels. What the canvas
// says of itself is in the screen's, and less where graphics are slow. And whether its visitor wishes a dark page.
(() => {
  const room = document.getElementById("lab-room"), axis = document.querySelector("#lab-timeline .lab-axis");
  const body = document.body;
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const gutter = () => room.offsetLeft - document.getElementById("lab-verdict").offsetLeft;
  const told = () => ({room: [room.clientWidth, room.clientHeight, gutter(), axis.clientWidth, axis.clientHeight]
    .map(Math.round).concat(parseFloat(getComputedStyle(document.getElementById("lab-stage")).fontSize)),
    dark: dark.matches});
  const paint = () => { body.classList.toggle("lab-dark", dark.matches); look(); };
  let last = "", soon = null, shown = "", due = null, laid = true;

  // What changes the layout of the page tears the picture until it has been drawn for the new one, which takes a slow machine
  // seconds: it is held back until then. The picture comes with its labels (js/stage.js), and is drawn some frames later.
  const FRAMES = 4, PATIENCE = 6000;
  function show(frames) {
    if (frames) requestAnimationFrame(() => laid && show(frames - 1)); else body.classList.remove("lab-settling");
  }
  function release() {
    if (laid) return;
    laid = true;
    clearTimeout(due);
    show(FRAMES);
  }
  function hold() {
    const size = `${innerWidth} ${innerHeight}`;
    if (size === shown) {
      laid = false;
      body.classList.add("lab-settling");
      clearTimeout(due);
      due = setTimeout(release, PATIENCE);
    }
    shown = size;
    look();
  }
  addEventListener("lab-laid", event => {
    if (`${event.detail}` === `${told().room.slice(0, 2)}`) release();
  });

  function tell() {
    soon = null;
    const now = JSON.stringify(told());
    if (now !== last) tellPage(JSON.parse(last = now));
  }
  function look() {
    soon ??= setTimeout(tell, 120);
  }

  new ResizeObserver(hold).observe(room);
  new ResizeObserver(look).observe(axis);
  dark.addEventListener("change", paint);
  paint();
  tell();
  addEventListener("lab-asked", () => { last = ""; look(); });  // somebody listens from now on
})();
