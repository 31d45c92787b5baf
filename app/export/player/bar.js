// The bar: two lanes of particles, the estimate above the truth, and crossings between them.

// Where particles are along the bar: those of a patch test, which moves on and on, in its first metre.
const alongBar = (run, at) => row(run.tracks.position, at).map((x) => run.moves_on ? x - Math.floor(x) : x);

function drawLanes(pen, run, view, at, place, {sizes, scale, flashed}) {
  const {estimate, truth, lane, crossings, field: box} = place, places = alongBar(run, at), over = 6 / place.pixels;
  const count = Math.round(1 / run.spacing), end = ROOM * box.half;
  for (const [colour, low, high] of [[GRID, box.middle - end, box.middle + end], [CELL, truth - lane / 2 - over, estimate + lane / 2 + over]]) {
    Object.assign(pen, {strokeStyle: colour, lineWidth: Math.min(1, 120 / count)});
    for (let k = 0; k <= count; k++) stroke(pen, [low, high].map((y) => [place.x(k / count), place.y(y)]));
  }
  [estimate, truth].forEach((y, half) => drawLane(pen, run, places, sizes[half], scale, place, place.y(y + lane / 2), lane * place.unit));
  for (const [p, age] of flashed) {
    pen.fillStyle = faded(age);
    disc(pen, place.x(places[p]), place.y(crossings), 4.5 * place.pixel);
  }
}

// Columns a little wider than a particle at rest, so that a gap shows only where the bar is stretched a lot.
function drawLane(pen, run, places, sizes, scale, place, y, height) {
  const column = 1.15 * place.across / run.shown;
  for (let p = 0; p < places.length; p++) {
    if (!(places[p] > -0.01 && places[p] < 1.01)) continue;
    pen.fillStyle = sizes ? shade(sizes[p], scale) : UNKNOWN;
    const start = Math.max(Math.round(place.x(places[p]) - column / 2), Math.round(place.x(0)));  // whole pixels: else the ground would shine
    pen.fillRect(start, y, Math.min(Math.ceil(column), Math.round(place.x(1)) - start), height);
  }
}

// From a crossing's colour to that of the ground.
function faded(age) {
  const [from, to] = DATA.colours.fading;
  return `rgb(${from.map((part, k) => Math.round(part + 0.85 * age * (to[k] - part)))})`;
}
