// Where things are: the stage of the live page (app/frame), x from 0 to 1 along the colour bar and y up, on a canvas.

const LINE = 15, NARROW = 540;  // pixels: a line of words; less has no room for all words of one
const EDGES = {left: 66, right: 22};  // for the numbers at the field plot's axis

function placeOf(problem, width, height) {
  const {rectangle: [, , low, high], anchors} = DATA.problems[problem], room = width - EDGES.left - EDGES.right;
  const unit = (height - (room < NARROW ? 2 * LINE : 0)) / (high - low);  // there the caption below takes more lines
  const across = anchors.middle ? Math.min(room, Math.max(unit, 480)) : room, left = EDGES.left + (room - across) / 2;
  const size = Math.min(unit, across / 0.93), {middle} = anchors, radius = middle && (anchors.outermost[0] - middle[0]) * size;
  const x = (share) => left + across * share, y = (up) => (high - up) * unit;
  // A place on a body in the plane, which is as wide as it is high.
  const onBody = (at, up) => middle ? [x(middle[0]) + size * (at - middle[0]), y(middle[1]) - size * (up - middle[1])] : [x(at), y(up)];
  return {width, unit, left, across, radius, x, y, onBody};
}

// Labels with these texts, or with their own, by their names; one that would lie on another goes below it.
function writeLabels(pen, place, labels, texts, colours = {}) {
  const taken = [];
  for (const {name, text: own, x, y, anchor, role, width} of labels) {
    const text = texts[name] ?? own;
    if (!text) continue;
    const [upright, side] = anchor.split("-"), lines = linesOf(pen, text, Math.min(place.width - 8, 6 * width || place.width, role === "silence" && place.radius ? 0.52 * place.radius : place.width));
    const long = Math.max(...lines.map((line) => pen.measureText(line).width)), high = LINE * lines.length;
    const [across, down] = role === "place" ? place.onBody(x, y) : [place.x(x), place.y(y)];
    const left = Math.min(Math.max(across - long * SHARES[side], 4), place.width - long - 4);
    let top = Math.max(0, down - high * SHARES[upright]);
    for (const other of taken) {
      const apart = left > other.left + other.long + 8 || other.left > left + long + 8 || top >= other.top + other.high || other.top >= top + high;
      if (!apart) top = other.top + other.high;
    }
    taken.push({left, long, top, high});
    if (role === "silence" || role === "place") {
      pen.fillStyle = "#fff";
      pen.fillRect(left - 4, top - 1, long + 8, high + 2);
    }
    lines.forEach((line, k) => words(pen, line, left + long * SHARES[side], top + LINE * k + 1, side, "top", colours[name]));
  }
}

const SHARES = {top: 0, left: 0, center: 0.5, right: 1, bottom: 1};

// A text at a place.
function words(pen, text, x, y, align = "left", baseline = "alphabetic", colour = "#15171c") {
  Object.assign(pen, {fillStyle: colour, textAlign: align, textBaseline: baseline});
  pen.fillText(text, x, y);
}

// A text in lines no longer than there is room for.
function linesOf(pen, text, room) {
  const lines = [""];
  for (const word of text.split(" ")) {
    const longer = `${lines[lines.length - 1]} ${word}`.trim();
    if (pen.measureText(longer).width <= room || !lines[lines.length - 1]) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines;
}

function stroke(pen, points) {
  pen.beginPath();
  points.forEach(([x, y], k) => k ? pen.lineTo(x, y) : pen.moveTo(x, y));
  pen.stroke();
}
