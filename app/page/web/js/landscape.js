// The error landscape under a slider: true error, estimate and time of a run over the slider's value; as words at a value, and
// as a drawing. A row (js/landscape_rows.js) has the data of its strip and the slider's thumb.
const landscape = (() => {
  const NEAR = 0.003, CROSS = 90;  // powers of ten; pixels for the words at the first crossing
  const VALUES = {cells: tr("{count} cells"), ppc: tr("{count} per cell"), amplitude: "A = {count}", modulus: "E = {count}",
    cfl: "CFL {count}"};
  const STATES = {pending: tr("not computed yet"), unstable: tr("the run is lost"), lost: tr("the run is lost"),
    refused: tr("not possible with these settings"), costly: tr("costly, not computed")};

  const share = value => value >= 1 ? tr("over 100 %") : numbers.perCent(value);
  const sized = (value, unit, digits) => unit ? numbers.withUnit(value, unit, digits) : numbers.number(value, digits);

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
      return {value, wrong: data.true[k], est: data.est[k], sec: data.sec[k], good: good(data, k), state: data.state[k], exact: true};
    const [wrong, est, sec] = [data.true, data.est, data.sec].map(numbers => between(data, numbers, value));
    if ((wrong ?? est) !== null) return {value, wrong, est, sec, good: true, state: "ok"};
    return {value, wrong: data.true[k], est: null, sec: data.sec[k], good: false, state: bad(data, k) ? data.state[k] : "pending"};
  }
  const named = (row, value) => VALUES[row.parameter].replace("{count}", sized(value, row.data.unit, row.data.multiple ? 6 : 3));
  function sentence(row, {value, wrong, est, sec, good, state, exact}, short = 0) {  // short: 1 or 2, without the time
    const most = exact ? tr("up to {share} wrong") : tr("about {share} wrong");
    const estimate = short ? tr("est. {share}") : tr("estimate {share}");
    const said = state !== "ok" ? [STATES[state]] : [
      wrong === null ? null : wrong >= 1 ? tr("over 100 % wrong") : most.replace("{share}", share(wrong)),
      good && est !== null && estimate.replace("{share}", share(est)), sec !== null && short < 2 && sized(sec, "s", 2)];
    return `${named(row, value)}: ${said.filter(Boolean).join(", ")}`;
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
    const words = (x, text, tint, anchor, y = H > 30 ? 16 : 13) =>
      `<text x="${x}" y="${y}" text-anchor="${anchor}" fill="var(--${tint})">${text}</text>`;
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
    const errors = [[data.true, "stroke:var(--truth);stroke-width:2.5"],
      [data.est, `stroke:${colour};stroke-width:1.5;stroke-dasharray:${dashes}`]];
    let svg = "";
    if (data.flat) {
      for (const [numbers, style] of [...errors, [data.sec, "stroke:var(--time);stroke-width:1.5"]])
        if (numbers[0] != null) svg += `<path d="M0 ${(numbers === data.sec ? H - 2 : y(numbers[0])).toFixed(1)}H${W}" style="${style}"/>`;
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
      const x = px(data.cross), thumb = px(at(row)), free = start => start >= 0 && start + CROSS <= W && (thumb < start || thumb > start + CROSS);
      const start = [x - CROSS, x, thumb + 6].find(free) ?? x;  // beside the thumb, not under it
      const over = read(row, 10 ** (from + (to - from) * (start + CROSS / 2) / W)), low = over.good && y(over.wrong ?? over.est) < H / 2;
      svg += `<path d="M${x} 0V${H}" style="stroke:var(--cross);stroke-width:1.25;stroke-dasharray:${speaks ? "none" : "2 2"}"/>`;
      if (speaks) svg += words(start + (start < x ? CROSS - 3 : 4), tr("first crossing"), "cross", start < x ? "end" : "start", low ? H - 4 : undefined);
    }
    if (data.bound !== null && data.complete) {
      svg += `<path d="M${px(data.bound)} 0V${H}" style="stroke:var(--ink3);stroke-dasharray:2 2"/>`;
      if (speaks) svg += words(px(data.bound) - 4, tr("step bound"), "ink2", "end");
    }
    const here = read(row, at(row)), x = px(at(row)), height = here.good ? y(here.wrong ?? here.est) : H;
    if (here.state !== "pending") svg += `<path d="M${x} -6V${height}" style="stroke:var(--accent);stroke-width:1.5"/>`;
    if (here.good) svg += dot(x, here.wrong, y, 3.5, "fill:var(--truth);stroke:var(--panel)")
      + dot(x, here.est, y, 5.5, `fill:none;stroke:${colour};stroke-width:1.5`);
    if (data.flat) {
      const right = px(at(row)) < W / 2;
      svg += words(right ? W - 6 : 6, tr("no effect: only the units change"), "ink2", right ? "end" : "start", H > 30 ? 16 : 11);
    }
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

  return {STATES, sized, share, ends, at, nearest, read, sentence, strip};
})();
