// A body in the plane: a ring, or a quarter of one and its mirror images, estimate on the left half, truth on the right.

function drawBody(pen, run, view, at, place, {sizes, scale, flashed}) {
  const {mirrors, outlined, lines} = DATA.problems[run.problem];
  const middle = [place.x(place.middle[0]), place.y(place.middle[1])], metre = place.radius * place.unit / run.outermost;
  drawSquares(pen, run, middle, metre, 1.05 * run.outermost);
  const places = row(run.tracks.position, at), n = run.shown, [shape, wide] = run.tile;
  drawParticles(pen, places, n, sizes, scale, middle, metre, mirrors, shape, wide * metre * Math.sqrt(run.particles / n));
  drawLevel(pen, middle, 1.05 * run.outermost * metre);
  if (run.tracks.line) drawLines(pen, row(run.tracks.line, at), lines, middle, metre);
  if (view.domains && run.tracks.edges) drawDomains(pen, places, row(run.tracks.edges, at), n, middle, metre, outlined);
  for (const [colour, radius] of [[GROUND, 4.2], [CROSSING, 2.7]]) {
    pen.fillStyle = colour;
    for (const [p] of flashed) {
      for (const [sx, sy] of mirrors) disc(pen, middle[0] + sx * metre * places[p], middle[1] - sy * metre * places[n + p], radius * place.pixel);
    }
  }
}

// The line between the halves.
function drawLevel(pen, [x, y], end) {
  Object.assign(pen, {strokeStyle: DOT, lineWidth: 1.2});
  stroke(pen, [[x, y - end], [x, y + end]]);
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
