// The error landscape under a slider: true error, estimate and time of a run over the slider's value. Only the row that is
// hovered, focused or held speaks: what it says takes the place of its name. What a strip shows comes as data of the mark
// before the slider; the row's own parts are put around the viewer's and stay when data come.
(() => {
  const root = document.getElementById("root"), rows = new Map(), LINE = 21, NEAR = 0.003;  // px; powers of ten
  const tell = said => dispatchEvent(new CustomEvent("lab-tell", {detail: said}));
  const set = (element, name, value) => element.getAttribute(name) !== value && element.setAttribute(name, value);
  const VALUES = {cells: tr("{count} cells"), ppc: tr("{count} per cell"), amplitude: "A = {count}", modulus: "E = {count}",
    cfl: "CFL {count}"};
  const KEEPS = {cfl: tr("keeps the CFL number"), dt: tr("keeps the time step")};
  const STATES = {pending: tr("not computed yet"), unstable: tr("the run is lost"), lost: tr("the run is lost"),
    refused: tr("not possible with these settings"), costly: tr("costly, not computed")};

  // Numbers as words.
  const digits = (value, count) => String(Number(value.toPrecision(count)));
  const share = value => value >= 1 ? tr("over 100 %") : `${digits(100 * value, 2)} %`;
  function sized(value, unit, count) {
    const power = Math.floor(Math.log10(Number(value.toPrecision(count))) / 3);
    return unit ? `${digits(value / 1000 ** power, count)} ${["n", "µ", "m", "", "k", "M", "G"][power + 3]}${unit}` : digits(value, count);
  }

  // A row's points, and what is between them.
  const error = (data, k) => data.true[k] ?? data.est[k];
  const good = (data, k) => data.state[k] === "ok" && error(data, k) !== null && error(data, k) < 1;
  const bad = (data, k) => ["unstable", "lost"].includes(data.state[k]) || data.state[k] === "ok" && error(data, k) >= 1;
  const ends = row => ["min", "max"].map(end => Number(row.thumb.getAttribute(`aria-value${end}`)));
  function at(row) {  // the slider's value
    const value = 10 ** Number(row.thumb.getAttribute("aria-valuenow")), {v, multiple} = row.data;
    if (row.wished && Date.now() < row.wished.until) return row.wished.value;
    const k = v ? nearest(row.data, value) : 0;
    return v && isPoint(row.data, value, k) ? v[k] : multiple ? Math.max(multiple, multiple * Math.round(value / multiple)) : value;
  }
  const nearest = (data, value) => data.v.reduce((best, v, k) =>
    Math.abs(Math.log(v / value)) < Math.abs(Math.log(data.v[best] / value)) ? k : best, 0);
  const isPoint = (data, value, k) => Math.abs(Math.log10(data.v[k] / value)) < NEAR;
  function between(data, numbers, value) {  // log-log, null where an end is unknown
    const k = data.v.findIndex(v => v >= value), part = k > 0 && Math.log(value / data.v[k - 1]) / Math.log(data.v[k] / data.v[k - 1]);
    return k > 0 && good(data, k) && good(data, k - 1) && numbers[k] && numbers[k - 1]
      ? numbers[k - 1] * (numbers[k] / numbers[k - 1]) ** part : null;
  }
  function read(row, value) {  // error, estimate and time at a value, and its state
    const {data} = row;
    if (!data.v) return null;
    const k = data.flat ? 0 : nearest(data, value);
    if (data.flat || isPoint(data, value, k))
      return {value, state: data.state[k], wrong: data.true[k], est: data.est[k], sec: data.sec[k], good: good(data, k), exact: true};
    const [wrong, est, sec] = [data.true, data.est, data.sec].map(numbers => between(data, numbers, value));
    return {value, wrong, est, sec, good: wrong !== null || est !== null, state: wrong ?? est ? "ok" : bad(data, k) ? data.state[k] : "pending"};
  }
  const named = (row, value) => VALUES[row.parameter].replace("{count}", sized(value, row.data.unit, row.data.multiple ? 6 : 3));
  function sentence(row, point, short = 0) {  // in a narrow panel without the time
    const {wrong, est, sec, state, exact} = point, most = exact ? tr("up to {share} wrong") : tr("about {share} wrong");
    const said = state !== "ok" ? [STATES[state]] : [
      wrong === null ? null : wrong >= 1 ? tr("over 100 % wrong") : most.replace("{share}", share(wrong)),
      point.good && est !== null && (short ? tr("est. {share}", {share: share(est)}) : tr("estimate {share}", {share: share(est)})), sec !== null && short < 2 && sized(sec, "s", 2)];
    return `${named(row, point.value)}: ${said.filter(Boolean).join(", ")}`;
  }

  // The drawing.
  const range = (numbers, least) => {
    let [low, high] = [Math.min(...numbers), Math.max(...numbers)];
    if (high / low < least) [low, high] = [Math.sqrt(low * high) / Math.sqrt(least), Math.sqrt(low * high) * Math.sqrt(least)];
    return [low, high];
  };
  function strip(row, speaks) {
    const {data, width: W, height: H} = row, [from, to] = ends(row), [colour, dashes] = data.line;
    const px = value => (Math.log10(value) - from) / (to - from) * W;
    if (!data.v) return "";
    const known = data.v.flatMap((_, k) => good(data, k) ? [data.true[k], data.est[k]].filter(Boolean) : []);
    const broken = data.v.some((_, k) => bad(data, k)), times = data.sec.filter(Boolean);
    let [low, high] = range([...known, ...broken ? [0.5] : [], ...known.length || broken ? [] : [1]], 3);
    if (data.flat) [low, high] = [low * 1.35, high * 1.35];  // words stand above the line
    const [quick, slow] = range(times.length ? times : [1], 3), scale = (value, least, most) =>
      H - 2 - (H - 5) * Math.log(Math.min(Math.max(value, least), most) / least) / Math.log(most / least);
    const y = value => scale(value, low, high);
    const words = (x, text, tint, anchor, y = H > 30 ? 16 : 13) => `<text x="${x}" y="${y}" text-anchor="${anchor}" fill="var(--${tint})">${text}</text>`;
    const path = (numbers, height, style) => {
      let d = "", up = true;
      data.v.forEach((v, k) => {
        if (numbers[k] === null) return void (up ||= data.state[k] !== "pending");
        d += `${up ? "M" : "L"}${px(v).toFixed(1)} ${height(numbers[k]).toFixed(1)}`;
        up = false;
      });
      return `<path d="${d}" style="${style}"/>`;
    };
    const where = data.flat ? [0, W] : [px(data.v[0]), px(data.v[data.v.length - 1])];
    const only = numbers => numbers.map((number, k) => good(data, k) ? number : null);
    const errors = [[data.true, "stroke:var(--truth);stroke-width:2.5"], [data.est, `stroke:${colour};stroke-width:1.5;stroke-dasharray:${dashes}`]];
    let svg = "";
    if (data.flat) {
      for (const [numbers, style] of [...errors, [data.sec, "stroke:var(--time);stroke-width:1.5"]])
        if (numbers[0] !== null) svg += `<path d="M0 ${(numbers === data.sec ? H - 2 : y(numbers[0])).toFixed(1)}H${W}" style="${style}"/>`;
    } else if (data.complete) {
      data.v.forEach((_, k) => {  // broken runs, from half way to their neighbours
        if (!bad(data, k) || k > 0 && bad(data, k - 1)) return;
        let last = k;
        while (last + 1 < data.v.length && bad(data, last + 1)) last++;
        const half = (one, other) => (px(data.v[one]) + px(data.v[other])) / 2, beyond = last + 1 === data.v.length;
        const left = k ? half(k - 1, k) : 0, right = beyond ? W : half(last, last + 1);
        svg += `<rect x="${left}" width="${right - left}" height="${H}" fill="url(#lab-hatch-${row.parameter})"/>`
          + `<path d="M${k ? left : right} 0V${H}" style="stroke:var(--bad-line)"/>`;
        const lost = data.state.slice(k, last + 1).some(state => state !== "ok");
        if (speaks && right - left > 76) svg += words(left + 5, lost ? tr("run is lost") : tr("over 100 %"), "bad-ink", "start");
      });
      svg += path(data.sec, value => scale(value, quick, slow), "stroke:var(--time);stroke-width:1.5");
      for (const [numbers, style] of errors) svg += path(only(numbers), y, style);
    } else {
      svg += `<path d="M2 ${H - 2}H${W - 2}" style="stroke:var(--line2);stroke-dasharray:2 4"/>`;
      data.v.forEach((v, k) => {
        if (bad(data, k)) svg += `<path d="m${px(v) - 3} 3 6 6m0-6-6 6" style="stroke:var(--bad-line);stroke-width:1.5"/>`;
        if (good(data, k)) svg += dot(px(v), data.est[k], y, 3.2, `fill:none;stroke:${colour};stroke-width:1.25`)
          + dot(px(v), data.true[k], y, 2, "fill:var(--truth)");
      });
    }
    if (data.cross !== null && data.complete && px(data.cross) > where[0] && px(data.cross) < where[1]) {
      const x = px(data.cross), left = x > 78;
      svg += `<path d="M${x} 0V${H}" style="stroke:var(--cross);stroke-width:1.25;stroke-dasharray:${speaks ? "none" : "2 2"}"/>`;
      if (speaks) svg += words(left ? x - 3 : x + 10, tr("first crossing"), "cross", left ? "end" : "start", left ? undefined : H - 4);
    }
    if (data.bound !== null && data.complete) {
      svg += `<path d="M${px(data.bound)} 0V${H}" style="stroke:var(--ink3);stroke-dasharray:2 2"/>`;
      if (speaks) svg += words(px(data.bound) - 4, tr("step bound"), "ink2", "end");
    }
    if (data.flat) {
      const right = px(at(row)) < W / 2;
      svg += words(right ? W - 6 : 6, tr("no effect: only the units change"), "ink2", right ? "end" : "start", H > 30 ? 16 : 11);
    }
    const here = read(row, at(row)), x = px(at(row)), height = here.good ? y(here.wrong ?? here.est) : H;
    if (here.state !== "pending") svg += `<path d="M${x} -6V${height}" style="stroke:var(--accent);stroke-width:1.5"/>`;
    if (here.good) svg += dot(x, here.wrong, y, 3.5, "fill:var(--truth);stroke:var(--panel)")
      + dot(x, here.est, y, 5.5, `fill:none;stroke:${colour};stroke-width:1.5`);
    if (row.hover !== null) {
      const over = read(row, row.hover);
      svg += `<path d="M${px(row.hover)} 0V${H}" style="stroke:var(--ink)"/>`;
      if (over.good) svg += dot(px(row.hover), over.wrong ?? over.est, y, 3, "fill:var(--ground);stroke:var(--truth);stroke-width:2");
    }
    return `<pattern id="lab-hatch-${row.parameter}" width="6" height="6" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">`
      + `<path d="M0 0H6V6H0" style="fill:var(--bad)"/><path d="M0 0V6" style="stroke:var(--bad-line)" opacity=".6"/></pattern>${svg}`;
  }
  const dot = (x, value, y, radius, style) => value === null ? "" :
    `<circle cx="${x.toFixed(1)}" cy="${y(value).toFixed(1)}" r="${radius}" style="${style}"/>`;

  function draw(row) {
    const value = row.hover ?? at(row), point = read(row, value);
    const speaks = Boolean(!row.named && (row.held || row.over || row.hover !== null || row.focused) && point);
    const said = point && sentence(row, point), own = row.hover === null ? said : row.data.v && sentence(row, read(row, at(row)));
    const key = [row.said, row.stale, at(row), ...ends(row), row.hover, speaks, row.width, row.height, row.label.dataset.words,
      document.body.classList.contains("lab-playing")].join();
    if (key === row.key) return;
    row.key = key;
    row.element.classList.toggle("lab-speaks", speaks);
    row.element.classList.toggle("lab-stale", row.stale);
    row.read.textContent = said || "";
    row.read.classList.remove("lab-tight");
    for (const short of [1, 2]) {
      if (!speaks || row.read.scrollWidth <= row.read.clientWidth) break;
      row.read.textContent = sentence(row, point, short);
      row.read.classList.add("lab-tight");
    }
    if (row.width) row.svg.innerHTML = strip(row, speaks);
    // A run that plays would be read out all the time.
    if (at(row) !== row.told || !document.body.classList.contains("lab-playing")) {
      row.told = at(row);
      set(row.thumb, "aria-valuetext", own || row.typed.value);
    }
    if (row.keeps) {
      const keeps = row.data.keeps;
      if (row.keeps.textContent !== KEEPS[keeps]) row.keeps.textContent = KEEPS[keeps];
      set(row.keeps, "aria-pressed", String(keeps === "dt"));
    }
    const after = `${Math.ceil(row.label.getBoundingClientRect().right - row.element.getBoundingClientRect().left)}px`;
    for (const element of [row.element, row.beside]) element?.style.setProperty("--after", after);
  }

  // What the visitor does.
  const sizes = new ResizeObserver(entries => {
    for (const {target, contentRect} of entries) {
      const row = [...rows.values()].find(one => one.strip === target);
      if (row) [row.width, row.height] = [contentRect.width, contentRect.height];
    }
    look();
  });
  const seen = new Set(), sight = new IntersectionObserver(entries => {
    for (const {target, isIntersecting} of entries) seen[isIntersecting ? "add" : "delete"](target);
    report();
  });
  let reported = "", reporting = null;
  function report() {  // which slider is in the hand; not each one that the pointer passes
    reporting ??= setTimeout(() => {
      reporting = null;
      const all = [...rows.values()], hand = all.find(row => row.held) || all.find(row => row.over) || all.find(row => row.focused);
      const strips = {hand: hand?.parameter || "", held: Boolean(hand?.held), seen: [...seen].some(strip => strip.isConnected)};
      if (JSON.stringify(strips) === reported) return;
      reported = JSON.stringify(strips);
      tell({strips});
    }, 100);
  }
  function choose(row, value) {
    row.wished = {value, until: Date.now() + 1500};  // until the page has set the slider
    tell({point: [row.parameter, value]});
    draw(row);
  }
  function pointed(row, event) {
    const box = row.strip.getBoundingClientRect(), [from, to] = ends(row);
    const value = 10 ** (from + (to - from) * Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)));
    if (!row.data.v) return null;
    const k = nearest(row.data, value);
    return row.data.flat ? Number(value.toPrecision(3)) : row.data.v[k];
  }
  const STEPS = {ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 3, PageDown: -3, Home: -1e9, End: 1e9};
  document.addEventListener("keydown", event => {
    const row = event.target.matches?.("[role=slider]") && [...rows.values()].find(one => one.thumb === event.target);
    if (!row || event.ctrlKey || event.metaKey || event.altKey) return;
    row.named = false;
    const {data} = row, step = STEPS[event.key];
    if (/^[0-9.,]$/.test(event.key)) {  // the key itself is written into the field
      event.stopPropagation();
      row.typed.focus();
      row.typed.select();
    } else if (event.key === "t" || event.key === "T") {
      event.preventDefault();
      event.stopPropagation();
      table(row);
    } else if (step && data.v && !data.flat) {
      event.preventDefault();
      event.stopPropagation();
      const points = data.v.filter((_, k) => data.state[k] !== "refused"), now = at(row);
      const on = step > 0 ? points.filter(v => v > now * (1 + 1e-6)) : points.filter(v => v < now * (1 - 1e-6)).reverse();
      if (on.length) choose(row, on[Math.min(Math.abs(step), on.length) - 1]);
    }
  }, true);
  addEventListener("pointerup", () => { for (const row of rows.values()) if (row.held) { row.held = false; change(row); } });
  function change(row) { draw(row); report(); }

  function table(row) {
    const {data} = row, name = row.label.textContent, dialog = document.getElementById("lab-table");
    if (!data.v) return;
    const cell = (tag, text) => `<${tag}>${text}</${tag}>`;
    const body = data.v.map((v, k) => `<tr>${cell("th", sized(v, data.unit, data.multiple ? 6 : 3))}${data.state[k] === "ok"
      ? [data.true, data.est].map(numbers => cell("td", numbers[k] === null ? "–" : share(numbers[k]))).join("")
      : `<td colspan="2">${STATES[data.state[k]]}</td>`}${cell("td", data.sec[k] === null ? "–" : sized(data.sec[k], "s", 2))}</tr>`);
    dialog.querySelector("h2").textContent = tr("Error over {name}", {name});
    dialog.querySelector("table").innerHTML = `<tr>${[name, tr("true"), tr("estimate"), tr("time")]
      .map(text => cell("th", text)).join("")}</tr>${body.join("")}`;
    dialog.showModal();
  }

  // A row's own parts, once for each slider that the viewer makes.
  function build(mark, element) {
    const thumb = element.querySelector("[role=slider]"), parameter = mark.dataset.parameter;
    const typed = mark.parentElement.nextElementSibling.nextElementSibling?.nextElementSibling?.querySelector("input");
    if (!thumb || !typed) return;
    element.insertAdjacentHTML("afterbegin", parameter === "modulus" ? "<button type='button' class='lab-keeps'></button>" : "");
    element.insertAdjacentHTML("beforeend", "<p class='lab-read' aria-hidden='true'></p><div class='lab-strip'>"
      + "<svg aria-hidden='true'></svg></div><button type='button' class='lab-as-table' tabindex='-1'></button>");
    const part = name => element.querySelector(name), row = {parameter, mark, element, thumb, typed, label: part("label"), read: part(".lab-read"),
      strip: part(".lab-strip"), svg: part(".lab-strip svg"), keeps: part(".lab-keeps"), data: {}, hover: null, width: 0,
      beside: parameter === "cfl" ? document.querySelector("[data-lab~=lab-auto] + div") : null};
    rows.set(parameter, row);
    typed.tabIndex = -1;
    part(".lab-as-table").textContent = tr("Error over {name} as a table", {name: row.label.textContent});
    part(".lab-as-table").addEventListener("click", () => table(row));
    row.keeps?.addEventListener("click", () => tell({keep: row.data.keeps === "dt" ? "cfl" : "dt"}));
    element.addEventListener("pointermove", event => {
      row.named = event.clientY - element.getBoundingClientRect().top < LINE;
      row.over = !row.named;
      row.hover = event.target.closest(".lab-strip") ? pointed(row, event) : null;
      change(row);
    });
    element.addEventListener("pointerleave", () => { [row.named, row.over, row.hover] = [false, false, null]; change(row); });
    part(".mantine-Slider-root").addEventListener("pointerdown", () => { row.held = true; row.wished = null; change(row); });
    row.strip.addEventListener("click", event => {
      const value = pointed(row, event);
      if (value !== null) choose(row, value);
      thumb.focus();
    });
    thumb.addEventListener("focus", () => { row.focused = true; change(row); });
    thumb.addEventListener("blur", () => { row.focused = false; change(row); });
    typed.addEventListener("focus", () => { row.before = typed.value; typed.select(); });
    typed.addEventListener("keydown", event => {
      if (event.key === "Escape") {
        typed.dataset.typed = "";
        write(typed, row.before);
      }
      if (event.key === "Escape" || event.key === "Enter") thumb.focus();
    });
    sizes.observe(row.strip);
    sight.observe(row.strip);
  }
  const setter = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set;
  function write(input, text) {
    setter.call(input, text);
    input.dispatchEvent(new Event("input", {bubbles: true}));
    input.dataset.typed = "";
  }

  // While a run plays or a slider is held not every point is computed, and one alone may come late: the curve goes through
  // those that are known. Where none is known yet, what was known before stays, faint.
  function take(row, data) {
    const known = (data.v || []).map((_, k) => k).filter(k => data.state[k] !== "pending");
    const computed = known.filter(k => data.state[k] !== "costly").length, waiting = (data.v || []).length - known.length;
    row.stale = Boolean(data.v && !computed && row.data.v && row.data.flat === data.flat);
    if (row.stale) return;
    const settles = computed > 1 && (waiting < 3 || document.body.classList.contains("lab-playing") || [...rows.values()].some(one => one.held));
    row.data = !settles ? data : {...data, complete: true,
      ...Object.fromEntries(["v", "true", "est", "sec", "state"].map(name => [name, known.map(k => data[name][k])]))};
  }

  function look() {
    for (const mark of root.querySelectorAll("i.lab-row")) {
      const element = mark.parentElement.nextElementSibling;
      if (element && rows.get(mark.dataset.parameter)?.element !== element) build(mark, element);
      const row = rows.get(mark.dataset.parameter);
      if (row?.element !== element) continue;
      if (row.said !== mark.dataset.said) {
        row.said = mark.dataset.said;
        take(row, JSON.parse(row.said));
      }
      if (row.wished && Math.abs(Math.log10(row.wished.value) - Number(row.thumb.getAttribute("aria-valuenow"))) < 1e-6) row.wished = null;
      draw(row);
    }
    for (const strip of seen) if (!strip.isConnected) { seen.delete(strip); report(); }
  }
  new MutationObserver(look).observe(root, {childList: true, subtree: true, attributes: true, attributeFilter: ["aria-valuenow", "data-words"]});
})();
