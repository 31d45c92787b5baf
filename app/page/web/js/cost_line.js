// The line of the accuracy that is wanted, in the chart of the Cost tab: dragged, or moved by keys, it writes into the
// box "Tolerance", and the page says which run is the cheapest below it.
(() => {
  const section = document.getElementById("lab-cost"), part = name => section.querySelector(name);
  const plot = part(".lab-plot"), dots = part(".lab-dots"), wish = part(".lab-wish");
  const lines = document.getElementsByClassName("lab-cost-line");
  let line = null, value = -3, dragged = false, due = 0;  // value: a power of ten, as the axis' ends are

  const said = () => line?.dataset || {}, ends = () => [Number(said().low ?? -4), Number(said().high ?? -1)];
  const percent = power => Number((100 * 10 ** power).toPrecision(2));

  function put() {
    const {text, spoken, marks} = said(), [low, high] = ends(), words = numbers.perCent(10 ** value).replace(" ", "\u00a0");
    section.classList.toggle("lab-wished", text !== undefined);
    plot.style.setProperty("--wish", `${100 * Math.min(1, Math.max(0, (high - value) / (high - low)))}%`);
    wish.classList.toggle("lab-dragged", dragged);
    wish.firstElementChild.textContent = dragged ? words : text || words;
    for (const [name, power] of [["min", low], ["max", high], ["now", value]])
      wish.setAttribute(`aria-value${name}`, percent(power));
    wish.setAttribute("aria-valuetext", spoken || words);
    for (const name of dots.querySelectorAll("span.lab-good")) name.remove();
    for (const dot of dots.querySelectorAll(".lab-good")) dot.classList.remove("lab-good");
    for (const [run, label] of JSON.parse(marks || "[]")) {  // the runs that answer
      const dot = dots.querySelector(`[data-run="${run}"]`);
      if (!dot) continue;
      dot.classList.add("lab-good");
      const name = makeElement("span", {className: "lab-on-stage lab-good", ariaHidden: "true"}, label);
      Object.assign(name.style, {left: dot.style.left, top: dot.style.top});
      dots.append(name);
    }
    dispatchEvent(new Event("lab-cost-wished"));
  }

  function move(power) {
    const [low, high] = ends(), wanted = Number((10 ** Math.min(high, Math.max(low, power))).toPrecision(2));
    value = Math.log10(wanted);
    put();
    clearTimeout(due);
    due = setTimeout(() => typeBehind("lab-wanted", `${percent(value)} %`), 40);
  }

  function look() {
    if (!lines[0] || lines[0] === line) return;
    line = lines[0];
    if (!dragged && said().value) value = Number(said().value);
    put();
  }

  wish.addEventListener("keydown", event => {
    const [low, high] = ends(), small = 0.05, large = 0.3;
    const way = {ArrowUp: small, ArrowRight: small, ArrowDown: -small, ArrowLeft: -small, PageUp: large,
      PageDown: -large, Home: low - value, End: high - value}[event.key];
    if (way === undefined) return;
    move(value + way);
    event.preventDefault();
    event.stopPropagation();
  });
  wish.addEventListener("pointerdown", event => {
    dragged = true;
    wish.setPointerCapture(event.pointerId);
  });
  wish.addEventListener("pointermove", ({clientY}) => {
    const {top, height} = dots.getBoundingClientRect(), [low, high] = ends();
    if (dragged) move(high - (clientY - top) / height * (high - low));
  });
  wish.addEventListener("lostpointercapture", () => {
    dragged = false;
    put();
  });
  addEventListener("lab-cost-drawn", put);
  watchPage(look);
})();
