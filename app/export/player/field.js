// The field plot: the quantity whose error is shown, of the particles and exact, and what particles miss as stems.

const {steps: AXIS_STEPS, room: ROOM, stems: MOST_STEMS} = DATA.axis;

// The exact field at a share of the way from the plot's start to its end.
function exactAt(curve, share) {
  const place = Math.min(Math.max(share, 0), 1) * (curve.length - 1), low = Math.min(Math.floor(place), curve.length - 2);
  return curve[low] + (place - low) * (curve[low + 1] - curve[low]);
}

// What the particles should have as it is drawn, and what they have: with so many times the deviation, where the exact one is
// known. Of a motion without swings deviations alone: the rest is the same everywhere.
function fieldOf(run, view, at) {
  const deviation = row(run.tracks[`deviation.${view.quantity}`], at), curve = run.tracks[`curve.${view.quantity}`];
  if (!curve) return {exact: null, values: deviation};
  const shares = run.tracks.along.values, line = run.moves_on ? null : row(curve, at);
  const exact = deviation.map((_, p) => line ? exactAt(line, shares[p]) : 0);
  return {exact, values: deviation.map((value, p) => exact[p] + view.magnified * value)};
}

// What the axis ends at: all that is drawn in the whole recording is on it, as far as it is not a run gone bad.
function axisTop(run, view) {
  const key = ["axis", view.quantity, view.magnified].join();
  if (!run[key]) {
    const curve = run.tracks[`curve.${view.quantity}`], reach = curve && !run.moves_on ? largest(curve.values.map(Math.abs)) : 0;
    let most = Math.max(reach, (run.least[view.quantity] || [0, 0])[1]);
    for (let k = 0; k < run.tracks.time.rows; k++) most = Math.max(most, largest(fieldOf(run, view, k).values.map(Math.abs)));
    most = reach && view.magnified === 1 ? Math.min(most, 4 * reach) : most;
    run[key] = most > SMALLEST ? roundUp(most / ROOM, AXIS_STEPS)[0] : 1;
  }
  return run[key];
}

// Where the particles are along the plot's axis, and the exact curve.
function alongOf(run, at) {
  const moved = run.tracks["curve.x"];
  return [alongBar(run, at), moved && !run.moves_on ? (share) => share + exactAt(row(moved, at), share) : (share) => share];
}

// Particles around the exact curve; those in `flashed` in a colour of their own; a pinned run's in grey. Returns the texts of its labels.
function drawField(pen, run, pinned, view, at, {name, remark}, place, flashed) {
  const {field: box} = place, own = axisTop(run, view), top = pinned ? Math.max(own, axisTop(pinned.run, view)) : own, end = ROOM * box.half;
  const y = (value) => place.y(box.middle + Math.min(Math.max(box.half * value / top, -end), end));
  const x = (share) => place.x(box.left + share * (box.right - box.left)), [along, exactAlong] = alongOf(run, at);
  Object.assign(pen, {lineWidth: 1, strokeStyle: AXIS});
  stroke(pen, [[x(0), y(0)], [x(1), y(0)]]);
  stroke(pen, [[x(0), place.y(box.middle - end)], [x(0), place.y(box.middle + end)]]);
  if (pinned) drawDots(pen, alongOf(pinned.run, pinned.at)[0], fieldOf(pinned.run, view, pinned.at).values, x, y, () => PINNED, 1.6);
  const {exact, values} = fieldOf(run, view, at), curve = run.tracks[`curve.${view.quantity}`];
  if (curve) {
    const line = run.moves_on ? [0, 0] : row(curve, at);
    Object.assign(pen, {lineWidth: 2.5 * place.pixel, strokeStyle: TRUTH});
    stroke(pen, Array.from(line, (value, k) => [x(exactAlong(k / (line.length - 1))), y(value)]));
    if (values.length <= MOST_STEMS) drawStems(pen, along, exact, values, x, y, place.pixel);
  }
  const size = (run.shown > 240 ? 1.4 : 2) * place.pixel;
  drawDots(pen, along, values, x, y, () => DOT, size);
  Object.assign(pen, {lineWidth: 1.75 * place.pixel, strokeStyle: CROSSING});
  for (const p of flashed) {
    if (!Number.isFinite(values[p])) continue;
    pen.beginPath();
    pen.arc(x(along[p]), y(values[p]), size + 2.5 * place.pixel, 0, 7);
    pen.stroke();
  }
  const unknown = run.tracks[`unknown.${view.quantity}`], count = unknown ? unknown.values[Math.floor(at)] : 0;
  const number = withUnit(top, DATA.quantities[view.quantity].unit), told = count ? fill(DATA.unknown, {remark, unknown: count}).replace(/^; /, "") : remark;
  return {"field/high": `+${number}`, "field/zero": "0", "field/low": `−${number.split(" ")[0]}`, "field/name": box.at ? name : "",
    "field/remark": (box.at ? [told] : [name, told]).filter(Boolean).join(": "), ...curve ? {} : {exact: ""},
    "field/magnified": curve && view.magnified > 1 ? tr("error × {magnified}", view) : ""};
}

function drawStems(pen, along, exact, values, x, y, pixel) {
  Object.assign(pen, {lineWidth: 1.5 * pixel, strokeStyle: STEM});
  for (let p = 0; p < values.length; p++) {
    if (!Number.isFinite(values[p]) || Math.abs(y(values[p]) - y(exact[p])) < 2) continue;
    stroke(pen, [[x(along[p]), y(exact[p])], [x(along[p]), y(values[p])]]);
  }
}

function drawDots(pen, along, values, x, y, colour, size) {
  for (let p = 0; p < values.length; p++) {
    if (!Number.isFinite(values[p]) || !(along[p] > -0.01 && along[p] < 1.01)) continue;
    pen.fillStyle = colour(p);
    disc(pen, x(along[p]), y(values[p]), size);
  }
}
