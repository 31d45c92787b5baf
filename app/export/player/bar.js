// The bar: two lanes of particles, the estimate above the truth, below the field plot with its grid.

// Where particles are along the bar: those of a patch test, which moves on and on, in its first metre.
const alongBar = (run, at) => row(run.tracks.position, at).map((x) => run.moves_on ? x - Math.floor(x) : x);

function drawLanes(pen, run, view, at, place, {sizes, scale}) {
  const {estimate, truth, lane, field: box} = place, places = alongBar(run, at), count = Math.round(1 / run.spacing), end = ROOM * box.half;
  Object.assign(pen, {strokeStyle: GRID, lineWidth: Math.min(1, 120 / count)});
  for (let k = 0; k <= count; k++) stroke(pen, [-end, end].map((y) => [place.x(k / count), place.y(box.middle + y)]));
  [estimate, truth].forEach((y, half) => drawLane(pen, run, places, sizes[half], scale, place, place.y(y + lane / 2),
    place.y(y - lane / 2) - place.y(y + lane / 2)));
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
