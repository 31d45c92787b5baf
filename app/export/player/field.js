// The field plot: the quantity whose error is shown, of the particles and exact, against where they were at rest.

const {steps: AXIS_STEPS, room: ROOM} = DATA.axis;

// The exact field at a share of the way from the plot's start to its end.
function exactAt(curve, share) {
  const place = Math.min(Math.max(share, 0), 1) * (curve.length - 1), low = Math.min(Math.floor(place), curve.length - 2);
  return curve[low] + (place - low) * (curve[low + 1] - curve[low]);
}

// Shares of the way of all particles, from their places at rest.
function sharesOf(run) {
  if (!run.shares) {
    const {start, end} = DATA.problems[run.problem].plot, rest = run.tracks.rest.values, n = run.shown;
    const along = rest.length > n ? (p) => Math.hypot(rest[p], rest[n + p]) : (p) => rest[p];
    run.shares = Float32Array.from({length: n}, (_, p) => (along(p) - start) / (end - start));
  }
  return run.shares;
}

// Values of all particles as they are drawn: exact plus so many times the deviation, where the exact one is known.
function fieldValues(run, view, at) {
  const track = run.tracks[`deviation.${view.quantity}`], curve = run.tracks[`curve.${view.quantity}`];
  const deviation = row(track, at);
  if (!curve) return deviation;
  const exact = row(curve, at), shares = sharesOf(run);
  return deviation.map((value, p) => exactAt(exact, shares[p]) + view.magnified * value);
}

// What the axis ends at: all that is drawn in the whole recording is on it, as far as it is not a run gone bad.
function axisTop(run, view) {
  const key = ["axis", view.quantity, view.magnified].join();
  if (!run[key]) {
    const curve = run.tracks[`curve.${view.quantity}`], reach = curve ? largest(curve.values.map(Math.abs)) : 0;
    let most = Math.max(reach, (run.least[view.quantity] || [0, 0])[1]);
    for (let k = 0; k < run.tracks.time.rows; k++) most = Math.max(most, largest(fieldValues(run, view, k).map(Math.abs)));
    most = reach && view.magnified === 1 ? Math.min(most, 4 * reach) : most;
    run[key] = most > SMALLEST ? roundUp(most / ROOM, AXIS_STEPS)[0] : 1;
  }
  return run[key];
}

// Particles as dots on the exact curve; those in `flashed` in magenta; a pinned run's in grey. Returns the texts of its labels.
function drawField(pen, run, pinned, view, at, caption, place, flashed) {
  const {plot} = DATA.problems[run.problem], own = axisTop(run, view), top = pinned ? Math.max(own, axisTop(pinned.run, view)) : own;
  const end = ROOM * plot.height, y = (value) => place.y(plot.middle + Math.min(Math.max(plot.height * value / top, -end), end));
  Object.assign(pen, {lineWidth: 1, strokeStyle: FAINT});
  stroke(pen, [[place.x(0), y(0)], [place.x(1), y(0)]]);
  stroke(pen, [[place.x(0), place.y(plot.middle - end)], [place.x(0), place.y(plot.middle + end)]]);
  if (pinned) drawDots(pen, pinned.run, fieldValues(pinned.run, view, pinned.at), place.x, y, () => FAINT, 2.6);
  const curve = run.tracks[`curve.${view.quantity}`];
  if (curve) {
    const exact = row(curve, at);
    Object.assign(pen, {lineWidth: 3.5, strokeStyle: TRUTH});
    stroke(pen, Array.from(exact, (value, k) => [place.x(k / (exact.length - 1)), y(value)]));
  }
  const lit = new Set(flashed), size = Math.min(2.4, Math.max(1.4, 0.28 * place.across / run.shown + 0.6));
  drawDots(pen, run, fieldValues(run, view, at), place.x, y, (p) => lit.has(p) ? `rgb(${FLASH})` : DOT, size);
  const unknown = run.tracks[`unknown.${view.quantity}`], count = unknown ? unknown.values[Math.floor(at)] : 0;
  const number = withUnit(top, DATA.quantities[view.quantity].unit);
  return {"field/high": number, "field/low": `−${number.split(" ")[0]}`, "field/caption": count ? fill(DATA.unknown, {caption, unknown: count}) : caption};
}

function drawDots(pen, run, values, x, y, colour, size) {
  const shares = sharesOf(run);
  for (let p = 0; p < values.length; p++) {
    if (!Number.isFinite(values[p])) continue;
    pen.fillStyle = colour(p);
    pen.fillRect(x(shares[p]) - size, y(values[p]) - size, 2 * size, 2 * size);
  }
}
