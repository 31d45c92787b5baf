// Round the curves of the error over time: its axis, the run's place in it, how far one can look back, since when it is lost,
// how often particles cross cells. Pointing at a time asks for the frame of then.
(() => {
  const axis = document.querySelector("#lab-timeline .lab-axis"), clock = document.getElementById("lab-clock");
  const title = document.querySelector("#lab-timeline .lab-names b");
  const make = name => Object.assign(axis.appendChild(document.createElement("span")), {className: `lab-${name}`});
  const [top, zero, begin, reach, lost, now, strip, read] =
    ["top", "zero", "begin", "reach", "gone", "now", "strip", "read"].map(make);
  const percent = part => `${100 * part}%`;
  lost.hidden = now.hidden = true;
  let ticks = [], said = "", held = false, waiting = null;

  const say = (element, text) => { if (element.textContent !== text) element.textContent = text; };

  function thin() {  // the last one has a unit, and is within the axis
    for (const tick of ticks) tick.hidden = false;
    const end = ticks.at(-1)?.getBoundingClientRect().left - 6;
    for (const tick of ticks.slice(0, -1)) tick.hidden = tick.getBoundingClientRect().right > end;
  }

  function write(at) {
    const [from, to] = at.reach;
    [[top, at.top[1]], [begin, at.start], [zero, "0"]].forEach(([element, text]) => say(element, text));
    top.style.top = percent(at.top[0]);
    while (ticks.length > at.ticks.length) ticks.pop().remove();
    while (ticks.length < at.ticks.length) ticks.push(make("tick"));
    at.ticks.forEach(([part, text], k) => {
      ticks[k].style.left = percent(part);
      say(ticks[k], text);
      ticks[k].classList.toggle("lab-last", part > 0.97);  // within the axis
    });
    thin();
    Object.assign(reach.style, {left: percent(from), width: percent(to - from)});
    reach.dataset.says = to > Math.max(0.12, from) ? tr("look back") : "";
    now.style.left = percent(at.now);
    now.hidden = false;
    lost.hidden = at.lost === null;
    if (at.lost !== null) lost.style.left = percent(at.lost);
    lost.dataset.says = at.says;
    lost.classList.toggle("lab-late", at.lost > 0.6);
    const step = 100 / 120;
    strip.style.background = at.strip && `linear-gradient(to right, ${[...at.strip].map((shade, k) =>
      `color-mix(in srgb, var(--cross) ${Math.round(10 + 90 * shade / 9)}%, var(--ground)) ${k * step}% ${(k + 1) * step}%`)
      .join(", ")}, transparent ${at.strip.length * step}%)`;
    read.textContent = at.read.join("\n");
    read.hidden = !at.read.length;
    const heading = at.symbol && tr("Error <i>norm </i><em>of </em>{symbol}", {symbol: at.symbol});  // where narrow without
    if (title.dataset.said !== heading) title.innerHTML = title.dataset.said = heading;
    clock.textContent = at.clock;
    document.body.classList.toggle("lab-playing", at.playing);
    document.body.classList.toggle("lab-lost", at.lost !== null);
    document.body.style.setProperty("--reach-from", from);
    document.body.style.setProperty("--reach-to", to);
  }

  function look() {
    const data = document.querySelector("i.lab-times")?.dataset;
    if (data && data.said !== said) write(JSON.parse(said = data.said));
  }

  const ask = (what, event) => {
    const box = axis.getBoundingClientRect(), part = Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
    waiting ??= setTimeout(() => waiting = null, 60);  // a hand moves more often than anything can be shown
    Object.assign(read.style, {left: percent(part), translate: part > 0.6 ? "calc(-100% - 8px)" : "8px"});
    dispatchEvent(new CustomEvent("lab-tell", {detail: {[what]: part}}));
  };
  axis.addEventListener("pointerdown", event => { held = true; axis.setPointerCapture(event.pointerId); ask("seek", event); });
  axis.addEventListener("pointermove", event => waiting || ask(held ? "seek" : "read", event));
  axis.addEventListener("pointerleave", () => dispatchEvent(new CustomEvent("lab-tell", {detail: {read: null}})));
  for (const end of ["pointerup", "pointercancel"])
    axis.addEventListener(end, event => { if (held && end === "pointerup") ask("seek", event); held = false; });
  new ResizeObserver(thin).observe(axis);
  new MutationObserver(look).observe(document.getElementById("root"), {childList: true, subtree: true});
})();
