// The field plot: the quantity whose error is shown, of the particles and exact, against where they were at rest.

const {steps: AXIS_STEPS, room: ROOM} = DATA.axis;
const NARROW = 540;  // pixels: less has no room for all words of a line

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

// Particles as dots on the exact curve within a box; those in `flashed` in magenta; a pinned run's in grey.
function drawField(pen, run, pinned, view, at, caption, box, flashed) {
  const {ends} = DATA.problems[run.problem].plot, quantity = DATA.quantities[view.quantity];
  const own = axisTop(run, view), top = pinned ? Math.max(own, axisTop(pinned.run, view)) : own;
  const middle = box.y + box.height / 2, half = box.height / 2 / ROOM;
  const x = (share) => box.x + share * box.width;
  const y = (value) => Math.min(Math.max(middle - half * value / top, box.y - 4), box.y + box.height + 4);
  pen.lineWidth = 1;
  pen.strokeStyle = FAINT;
  stroke(pen, [[box.x, middle], [box.x + box.width, middle]]);
  stroke(pen, [[box.x, box.y], [box.x, box.y + box.height]]);
  const unit = withUnit(top, quantity.unit);
  words(pen, unit, box.x - 6, y(top), "right", "middle");
  words(pen, "0", box.x - 6, middle, "right", "middle");
  words(pen, `−${unit.split(" ")[0]}`, box.x - 6, y(-top), "right", "middle");
  if (pinned) drawDots(pen, pinned.run, fieldValues(pinned.run, view, pinned.at), x, y, () => FAINT, 2.6);
  const curve = run.tracks[`curve.${view.quantity}`];
  if (curve) {
    const exact = row(curve, at);
    pen.lineWidth = 3.5;
    pen.strokeStyle = TRUTH;
    stroke(pen, Array.from(exact, (value, k) => [x(k / (exact.length - 1)), y(value)]));
  }
  const lit = new Set(flashed);
  drawDots(pen, run, fieldValues(run, view, at), x, y, (p) => lit.has(p) ? `rgb(${FLASH})` : DOT, Math.min(2.4, Math.max(1.4, 0.28 * box.width / run.shown + 0.6)));
  const unknown = run.tracks[`unknown.${view.quantity}`], count = unknown ? unknown.values[Math.floor(at)] : 0;
  const told = count ? fill(DATA.unknown, {caption, unknown: count}) : caption;
  const below = box.y + box.height + 8, narrow = box.width < NARROW;
  words(pen, ends[0], box.x, below, "left", "top");
  words(pen, ends[1], box.x + box.width, below, "right", "top");
  words(pen, told, box.x + box.width / 2, below + (narrow ? 16 : 0), "center", "top", narrow ? box.width + 40 : 0);
}

function drawDots(pen, run, values, x, y, colour, size) {
  const shares = sharesOf(run);
  for (let p = 0; p < values.length; p++) {
    if (!Number.isFinite(values[p])) continue;
    pen.fillStyle = colour(p);
    pen.fillRect(x(shares[p]) - size, y(values[p]) - size, 2 * size, 2 * size);
  }
}

function stroke(pen, points) {
  pen.beginPath();
  points.forEach(([x, y], k) => k ? pen.lineTo(x, y) : pen.moveTo(x, y));
  pen.stroke();
}
