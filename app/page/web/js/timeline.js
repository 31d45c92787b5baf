// Round the curves of the error over time: its axis, their names, the run's place in it, how far one can look back, since when
// it is lost, when particles change their cell. Pointing at a time asks for the frame of then.
(() => {
  const axis = document.querySelector("#lab-timeline .lab-axis"), clock = document.getElementById("lab-clock");
  const [heading, about, changes] = document.querySelectorAll("#lab-timeline .lab-names > *");
  const make = name => axis.appendChild(makeElement("span", {className: `lab-${name}`}));
  const [zero, begin, reach, lost, now, strip, first, read] =
    ["zero", "begin", "reach", "gone", "now", "strip", "first", "read"].map(make);
  const percent = part => `${100 * part}%`;
  lost.hidden = now.hidden = true;
  let said = "", held = false, waiting = null;
  const ticks = [], tops = [], names = [];
  const fit = (list, count, kind) => {
    while (list.length > count) list.pop().remove();
    while (list.length < count) list.push(make(kind));
  };

  function thin() {  // the last one has a unit, and is within the axis
    for (const tick of ticks) tick.hidden = false;
    const end = ticks.at(-1)?.getBoundingClientRect().left - 6;
    for (const tick of ticks.slice(0, -1)) tick.hidden = tick.getBoundingClientRect().right > end;
  }

  function write(at) {
    const [from, to] = at.reach;
    const [title, subject] = at.title || [tr("Error"), tr("over time")];
    [[begin, at.start], [zero, at.zero || "0 %"], [heading, title], [about, subject], [changes, at.title ? "" : tr("cell changes")]].forEach(([element, text]) => changeText(element, text));
    fit(tops, at.tops.length, "top");
    at.tops.forEach(([part, text], k) => { tops[k].style.top = percent(part); changeText(tops[k], text); });
    fit(ticks, at.ticks.length, "tick");
    at.ticks.forEach(([part, text], k) => {
      ticks[k].style.left = percent(part);
      changeText(ticks[k], text);
      ticks[k].classList.toggle("lab-last", part > 0.97);  // within the axis
    });
    thin();
    Object.assign(reach.style, {left: percent(from), width: percent(to - from)});
    reach.dataset.says = to > Math.max(0.12, from) && at.now >= to ? tr("look back") : "";  // who does knows
    now.style.left = percent(at.now);
    now.hidden = false;
    lost.hidden = at.lost === null;
    if (at.lost !== null) lost.style.left = percent(at.lost);
    lost.dataset.says = at.says;
    lost.classList.toggle("lab-late", at.lost > 0.6);
    strip.style.background = at.changes.map(part => `linear-gradient(var(--cross), var(--cross)) ${percent(part)} 0 / 1.5px 100% no-repeat`).join(", ");
    strip.title = at.many || "";
    changeText(first, at.changes[0] > 0.16 ? at.first : "");  // where there is room left of it
    first.style.right = percent(1 - (at.changes[0] || 0));
    nameLines(at);
    read.textContent = at.read.join("\n");
    read.hidden = !at.read.length;
    clock.textContent = at.clock;
    document.body.classList.toggle("lab-playing", at.playing);
    document.body.classList.toggle("lab-lost", at.lost !== null);
    document.body.style.setProperty("--reach-from", from);
    document.body.style.setProperty("--reach-to", to);
  }

  // At the ends of the lines, also for who looks back, one line of text apart at least.
  function nameLines({names: told, now, reach: [, newest]}) {
    const end = Math.max(now, newest);
    fit(names, told.length, "name");
    const high = axis.clientHeight, line = 1.25 * parseFloat(getComputedStyle(zero).fontSize), places = told.map(([,, y]) => y * high);
    const order = told.map((_, k) => k).sort((a, b) => places[a] - places[b]);
    order.forEach((k, n) => { if (n) places[k] = Math.max(places[k], places[order[n - 1]] + line); });
    const over = Math.max(0, (places[order.at(-1)] || 0) - high);
    told.forEach(([text, colour], k) => {
      changeText(names[k], text);
      names[k].style.cssText = `left: calc(${percent(end)} + 8px); top: ${places[k] - over}px; color: color-mix(in srgb, var(--${colour}, var(--before)) 65%, var(--ink))`;
    });
  }

  function look() {
    const data = document.querySelector("i.lab-times")?.dataset;
    if (data && data.said !== said) write(JSON.parse(said = data.said));
  }

  const ask = (what, event) => {
    const box = axis.getBoundingClientRect(), part = Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
    waiting ??= setTimeout(() => waiting = null, 60);  // a hand moves more often than anything can be shown
    Object.assign(read.style, {left: percent(part), translate: part > 0.6 ? "calc(-100% - 8px)" : "8px"});
    tellPage({[what]: part});
  };
  axis.addEventListener("pointerdown", event => { held = true; axis.setPointerCapture(event.pointerId); ask("seek", event); });
  axis.addEventListener("pointermove", event => waiting || ask(held ? "seek" : "read", event));
  axis.addEventListener("pointerleave", () => tellPage({read: null}));
  for (const end of ["pointerup", "pointercancel"])
    axis.addEventListener(end, event => { if (held && end === "pointerup") ask("seek", event); held = false; });
  new ResizeObserver(() => { if (said) write(JSON.parse(said)); }).observe(axis);
  watchPage(look);
})();
