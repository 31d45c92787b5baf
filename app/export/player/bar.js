// The bar: two lanes of particles, the estimate above the truth, and crossings between them.

function drawLanes(pen, run, view, at, place, {sizes, scale, flashed}) {
  const {anchors: {estimate: [, estimate], truth: [, truth], lane: [, top]}} = DATA.problems.bar, height = 2 * (top - estimate);
  const places = row(run.tracks.position, at).map((x) => run.moves_on ? x - Math.floor(x) : x);
  const count = Math.round(1 / run.spacing);
  Object.assign(pen, {strokeStyle: CELL, lineWidth: Math.min(1, 120 / count)});
  for (let k = 0; k <= count; k++) stroke(pen, [truth - 0.7 * height, estimate + 0.7 * height].map((y) => [place.x(k / count), place.y(y)]));
  [estimate, truth].forEach((y, half) => drawLane(pen, run, places, sizes[half], scale, place, place.y(y + height / 2), height * place.unit));
  for (const [p, ago] of flashed) {
    pen.fillStyle = faded(ago);
    pen.beginPath();
    pen.arc(place.x(places[p]), place.y((estimate + truth) / 2), 4, 0, 7);
    pen.fill();
  }
}

// Columns a little wider than a particle at rest, so that a gap shows only where the bar is stretched a lot.
function drawLane(pen, run, places, sizes, scale, place, y, height) {
  const column = 1.15 * place.across / run.shown;
  for (let p = 0; p < places.length; p++) {
    if (!(places[p] > -0.04 && places[p] < 1.04)) continue;
    pen.fillStyle = sizes ? shade(sizes[p], scale) : UNKNOWN;
    const start = Math.round(place.x(places[p]) - column / 2);  // whole pixels: between halves of them the ground would shine
    pen.fillRect(start, y, Math.ceil(column), height);
  }
}

// From magenta to the white of the ground.
function faded(ago) {
  return `rgb(${FLASH.map((part) => Math.round(part + (255 - part) * Math.min(ago / DATA.flash_seconds, 1)))})`;
}
