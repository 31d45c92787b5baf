// The bar: two lanes of particles, the estimate above the truth, crossings between them, and the field plot below.

function drawBar(pen, run, pinned, view, scene) {
  const {width, height, at, sizes, scale, said, flashed} = scene;
  const left = 66, right = width - 22, across = right - left, top = 66;
  const lane = Math.max(30, 0.085 * height), gap = Math.max(26, 0.05 * height);
  const first = top + 24, second = first + lane + gap, low = second + lane;
  const x = (place) => left + across * Math.min(Math.max(place, -0.04), 1.04);
  drawColourBar(pen, scale, said.measures, scene.unit, left, right, 24);
  words(pen, said.titles[0], left, first - 9, "left", "bottom");
  drawCells(pen, run, x, first - 8, low + 8);
  const places = row(run.tracks.position, at).map((place) => run.moves_on ? place - Math.floor(place) : place);
  drawLane(pen, run, places, sizes[0], scale, x, across, first, lane, said.silences[0]);
  drawLane(pen, run, places, sizes[1], scale, x, across, second, lane, said.silences[1]);
  for (const [p, ago] of flashed) {
    pen.fillStyle = faded(ago);
    pen.beginPath();
    pen.arc(x(places[p]), first + lane + gap / 2, 4, 0, 7);
    pen.fill();
  }
  words(pen, said.titles[1], left, low + 10, "left", "top");
  const note = pen.measureText(run.marks).width + pen.measureText(said.titles[1]).width + 30 < across;
  words(pen, run.marks, right, low + (note ? 10 : 26), "right", "top", 0, "#8a0052");
  const start = low + (note ? 40 : 56), narrow = across < NARROW;
  drawField(pen, run, pinned, view, at, said.field, {x: left, y: start, width: across, height: height - start - (narrow ? 58 : 30)},
    flashed.map(([p]) => p));
}

function drawCells(pen, run, x, high, low) {
  const count = Math.round(1 / run.spacing);
  pen.strokeStyle = CELL;
  pen.lineWidth = Math.min(1, 120 / count);
  for (let k = 0; k <= count; k++) stroke(pen, [[x(k / count), high], [x(k / count), low]]);
}

// Columns a little wider than a particle at rest, so that a gap shows only where the bar is stretched a lot.
function drawLane(pen, run, places, sizes, scale, x, across, y, height, silence) {
  const column = 1.15 * across / run.shown;
  for (let p = 0; p < places.length; p++) {
    if (!(places[p] > -0.04 && places[p] < 1.04)) continue;
    pen.fillStyle = sizes ? shade(sizes[p], scale) : UNKNOWN;
    const start = Math.round(x(places[p]) - column / 2);  // whole pixels: between halves of them the ground would shine
    pen.fillRect(start, y, Math.ceil(column), height);
  }
  if (silence) {
    const room = 0.8 * across, lines = linesOf(pen, silence, room), middle = x(0.5);
    pen.fillStyle = "#fff";
    pen.fillRect(middle - room / 2 - 6, y + height / 2 - 8 * lines.length - 2, room + 12, 16 * lines.length + 4);
    words(pen, silence, middle, y + height / 2, "center", "middle", room);
  }
}

// From magenta to the white of the ground.
function faded(ago) {
  return `rgb(${FLASH.map((part) => Math.round(part + (255 - part) * Math.min(ago / DATA.flash_seconds, 1)))})`;
}
