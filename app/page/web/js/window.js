// Tells the page how much room there is: for the stage and the plot over time, in the window's own pixels. What the canvas
// says of itself is in the screen's, and less where graphics are slow. And whether its visitor wishes a dark page.
(() => {
  const room = document.getElementById("lab-room"), axis = document.querySelector("#lab-timeline .lab-axis");
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const gutter = () => parseFloat(getComputedStyle(document.body).getPropertyValue("--gutter"));
  const told = () => ({room: [room.clientWidth, room.clientHeight, gutter(), axis.clientWidth, axis.clientHeight]
    .map(Math.round).concat(parseFloat(getComputedStyle(document.getElementById("lab-stage")).fontSize)),
    dark: dark.matches});
  const paint = () => { document.body.classList.toggle("lab-dark", dark.matches); look(); };
  let last = "", soon = null;

  function look() {
    soon ??= setTimeout(() => {
      soon = null;
      const now = JSON.stringify(told());
      if (now !== last) dispatchEvent(new CustomEvent("lab-tell", {detail: JSON.parse(last = now)}));
    }, 120);
  }

  for (const element of [room, axis]) new ResizeObserver(look).observe(element);
  dark.addEventListener("change", paint);
  paint();
  addEventListener("lab-asked", () => { last = ""; look(); });  // somebody listens from now on
})();
