// Rows of sliders with the error landscape under them. Only the row that is hovered, focused or held speaks: what it says
// takes the place of its name. The data of all strips come in one element; the row's own parts are put around the viewer's
// and stay when data come.
(() => {
  const {STATES, sized, share, ends, at, nearest, read, sentence, strip} = landscape;
  const root = document.getElementById("root"), rows = new Map(), LINE = 21;  // px: height of the name
  const tell = said => dispatchEvent(new CustomEvent("lab-tell", {detail: said}));
  const set = (element, name, value) => element.getAttribute(name) !== value && element.setAttribute(name, value);
  const playing = () => document.body.classList.contains("lab-playing");
  const KEEPS = {cfl: tr("keeps the CFL number"), dt: tr("keeps the time step")};

  function draw(row) {
    const value = row.hover ?? at(row), point = read(row, value);
    const speaks = Boolean(!row.named && (row.held || row.over || row.hover !== null || row.focused) && point);
    const said = point && sentence(row, point), own = row.hover === null ? said : row.data.v && sentence(row, read(row, at(row)));
    const key = [row.said, row.stale, at(row), ...ends(row), row.hover, speaks, row.width, row.height, row.label.dataset.words,
      playing()].join();
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
    if (at(row) !== row.told || !playing()) {
      row.told = at(row);
      set(row.thumb, "aria-valuetext", own || row.typed.value);
    }
    if (row.keeps) {
      const keeps = row.data.keeps;
      if (row.keeps.textContent !== KEEPS[keeps]) row.keeps.textContent = KEEPS[keeps];
      set(row.keeps, "aria-pressed", String(keeps === "dt"));
    }
    const name = [row.label.textContent, row.label.dataset.words, speaks, row.width].join();
    if (name !== row.measured) {  // to measure it makes the browser lay out the page
      row.measured = name;
      const after = `${Math.ceil(row.label.getBoundingClientRect().right - row.element.getBoundingClientRect().left)}px`;
      for (const element of [row.element, row.beside]) element?.style.setProperty("--after", after);
    }
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
      const strips = {hand: hand?.parameter || "", held: Boolean(hand?.held), 
        seen: [...seen].some(strip => strip.checkVisibility({visibilityProperty: true}))};
      if (JSON.stringify(strips) === reported) return;
      reported = JSON.stringify(strips);
      tell({strips});
    }, 100);
  }
  new MutationObserver(report).observe(document.body, {attributes: true, attributeFilter: ["class"]});  // a talk hides the panel
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
  const STEPS = {ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 3, PageDown: -3};  // Home and End: the slider's own ends
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
  for (const end of ["pointerup", "pointercancel"])
    addEventListener(end, () => { for (const row of rows.values()) if (row.held) { row.held = false; change(row); } });
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
    const part = name => element.querySelector(name);
    const row = {parameter, mark, element, thumb, typed, label: part("label"), read: part(".lab-read"),
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

  // The curve passes over what is too costly; and while a run plays or a slider is held, and where hardly any point is left,
  // over what is not computed yet. Where nothing is known, what was known before stays, faint.
  function take(row, data) {
    if (!data.v) return void (row.data = data);
    const all = data.v.map((_, k) => k), known = all.filter(k => !["pending", "costly"].includes(data.state[k]));
    const waiting = all.filter(k => data.state[k] === "pending").length;
    row.stale = Boolean(!known.length && row.data.v && row.data.flat === data.flat);
    if (row.stale) return;
    const settles = known.length > 1 && (waiting < 3 || playing() || [...rows.values()].some(one => one.held));
    const beyond = k => !known.length || k < known[0] || k > known[known.length - 1];
    const kept = all.filter(k => data.state[k] === "costly" ? beyond(k) : !settles || known.includes(k));
    row.data = {...data, complete: data.complete || settles,
      ...Object.fromEntries(["v", "true", "est", "sec", "state"].map(name => [name, kept.map(k => data[name][k])]))};
  }

  let landscapes = "", data = {};
  function look() {
    const news = root.querySelector("i.lab-landscapes")?.dataset.said;
    if (news && news !== landscapes) {
      data = JSON.parse(landscapes = news);
      const [colour, dashes] = Object.values(data)[0]?.line || ["", ""];  // of the estimate in the legend
      document.body.style.setProperty("--judge-line", colour);
      document.body.style.setProperty("--judge-dashes", dashes || "none");
    }
    for (const mark of root.querySelectorAll("i.lab-row")) {
      const element = mark.parentElement.nextElementSibling;
      if (element && rows.get(mark.dataset.parameter)?.element !== element) build(mark, element);
      const row = rows.get(mark.dataset.parameter);
      const own = data[mark.dataset.parameter];
      if (row?.element !== element || !own) continue;
      if (row.own !== own) {
        row.own = own;
        const said = JSON.stringify(own);
        if (row.said !== said) {
          row.said = said;
          set(row.label, "data-words", own.words);
          take(row, own);
        }
      }
      const now = Number(row.thumb.getAttribute("aria-valuenow"));
      if (row.wished && Math.abs(Math.log10(row.wished.value) - now) < 1e-6) row.wished = null;
      draw(row);
    }
    for (const strip of seen) if (!strip.isConnected) { seen.delete(strip); report(); }
  }
  new MutationObserver(look).observe(root, {childList: true, subtree: true, attributes: true,
    attributeFilter: ["aria-valuenow", "data-words"]});
})();
