// A body in the plane: a ring, or a quarter of one and its mirror images, estimate on the left half, truth on the right.

function drawBody(pen, run, view, at, place, {sizes, scale, changed}) {
  const {mirrors, outlined, lines} = DATA.problems[run.problem];
  const middle = [place.x(place.middle[0]), place.y(place.middle[1])], metre = place.radius * place.unit / run.outermost;
  drawSquares(pen, run, middle, metre, 1.05 * run.outermost);
  const places = row(run.tracks.position, at), n = run.shown, [shape, wide] = run.tile;
  drawParticles(pen, places, n, sizes, scale, middle, metre, mirrors, shape, wide * metre * Math.sqrt(run.particles / n));
  drawLevel(pen, places, n, middle, metre, run.outermost);
  if (run.tracks.line) drawLines(pen, row(run.tracks.line, at), lines, middle, metre);
  if (view.domains && run.tracks.edges) drawDomains(pen, places, row(run.tracks.edges, at), n, middle, metre, outlined);
  pen.strokeStyle = CROSSING;
  for (const p of changed) {
    for (const [sx, sy] of mirrors) ring(pen, middle[0] + sx * metre * places[p], middle[1] - sy * metre * places[n + p], wide * metre / 2 + 1.5 * place.pixel, 2 * place.pixel);
  }
}

// The line between the halves, across the wall alone.
function drawLevel(pen, places, n, [x, y], metre, end) {
  let low = Infinity, high = 0;
  for (let p = 0; p < n; p++) {
    const far = Math.hypot(places[p], places[n + p]);
    if (far < low) low = far;
    if (far > high) high = Math.min(far, end);
  }
  Object.assign(pen, {strokeStyle: DOT, lineWidth: 1.5});
  pen.setLineDash([5, 4]);
  for (const side of [1, -1]) stroke(pen, [[x, y - side * low * metre], [x, y - side * high * metre]]);
  pen.setLineDash([]);
}

// Errors of the particles across the body, on the scale of the colours: true ones as dots, estimates as rings. Returns the texts of its labels.
function drawErrors(pen, run, place, ticks, [estimates, truths], scale, [estimate]) {
  const box = place.plot, along = run.tracks.along.values;
  if (!box) return {};
  const x = (share) => place.x(box.left + share * (box.right - box.left)), y = (share) => place.y(box.low + share * (box.high - box.low));
  const bar = place.x(box.left) - 9 * place.pixel, rows = Math.ceil(y(0) - y(1));
  for (let k = 0; k < rows; k++) {
    pen.fillStyle = SHADES[Math.floor(255 * k / rows)];
    pen.fillRect(bar, y(0) - k - 1, 6 * place.pixel, 1.5);
  }
  for (const [share, text] of ticks) {
    Object.assign(pen, {strokeStyle: GRID, lineWidth: 1});
    stroke(pen, [[x(0), y(share)], [x(1), y(share)]]);
    words(pen, text === DATA.scale.zero ? "0" : text, bar - 3 * place.pixel, y(share), "right", "middle", DATA.colours.tones.plain);
  }
  const dots = (sizes, act) => sizes && sizes.forEach((size, p) => {
    if (Number.isFinite(size) && Number.isFinite(along[p])) act(x(along[p]), y(Math.min(Math.max(shareOf(size, scale), 0), 1)));
  });
  pen.strokeStyle = DATA.colours.estimate;
  dots(estimates, (across, up) => ring(pen, across, up, 3.5 * place.pixel, 1.5 * place.pixel));
  pen.fillStyle = TRUTH;
  dots(truths, (across, up) => disc(pen, across, up, 2.25 * place.pixel));
  return {"plot/estimate": estimate};
}

function drawSquares(pen, run, middle, metre, reach) {
  const {spacing, first_line: start} = run, end = reach * metre;
  Object.assign(pen, {strokeStyle: GRID, lineWidth: 1});
  for (let k = Math.ceil((-reach - start) / spacing); k <= (reach - start) / spacing; k++) {
    const at = (k * spacing + start) * metre;
    stroke(pen, [[middle[0] + at, middle[1] - end], [middle[0] + at, middle[1] + end]]);
    stroke(pen, [[middle[0] - end, middle[1] - at], [middle[0] + end, middle[1] - at]]);
  }
}

// Lines of material as the exact solution has them: one is recorded, the others are that one, turned.
function drawLines(pen, line, count, middle, metre) {
  const n = line.length / 2;
  Object.assign(pen, {strokeStyle: TRUTH, lineWidth: 1.5});
  for (let k = 0; k < count; k++) {
    const c = Math.cos(2 * Math.PI * k / count), s = Math.sin(2 * Math.PI * k / count);
    stroke(pen, Array.from({length: n}, (_, p) => [middle[0] + metre * (c * line[p] - s * line[n + p]), middle[1] - metre * (s * line[p] + c * line[n + p])]));
  }
}

// So large that they tile the body.
function drawParticles(pen, places, n, sizes, scale, middle, metre, mirrors, shape, wide) {
  for (let p = 0; p < n; p++) {
    for (const [sx, sy] of mirrors) {
      const x = sx * places[p], half = sizes[x < 0 ? 0 : 1], across = middle[0] + metre * x, down = middle[1] - sy * metre * places[n + p];
      pen.fillStyle = half ? shade(half[p], scale) : UNKNOWN;
      if (shape === "square") pen.fillRect(across - wide / 2, down - wide / 2, wide, wide); else disc(pen, across, down, wide / 2);
    }
  }
}

// What each particle stands for: a box for GIMP, a parallelogram for CPDI.
function drawDomains(pen, places, edges, n, middle, metre, images) {
  Object.assign(pen, {strokeStyle: GROUND, lineWidth: 1});
  pen.beginPath();
  for (let p = 0; p < n; p++) {
    const first = [edges[p], edges[n + p]], second = [edges[2 * n + p], edges[3 * n + p]];
    for (const [side, up] of images) {
      [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]].forEach(([a, b], k) => {
        const x = middle[0] + side * metre * (places[p] + a * first[0] + b * second[0]);
        const y = middle[1] - up * metre * (places[n + p] + a * first[1] + b * second[1]);
        if (k) pen.lineTo(x, y); else pen.moveTo(x, y);
      });
    }
  }
  pen.stroke();
}
