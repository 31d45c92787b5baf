// Where things are: the stage of the live page (app/frame), x from 0 to 1 along the colour bar and y up, on a canvas. It is
// laid out for a window or for one as narrow as a phone's, and enlarged until it fits.

const NARROW = 480, LEAST_LETTERS = 11, LETTERS = 12.5;  // pixels: of a canvas, and of a line of words
const SHARES = {top: 0, left: 0, center: 0.5, right: 1, bottom: 1};

function placeOf(problem, width, height) {
  const room = DATA.problems[problem].rooms[width < NARROW ? "narrow" : "wide"], beside = room.gutter + 2 * DATA.edge;
  const unit = Math.min(width / (1 + beside), height / room.high), letters = Math.max(LEAST_LETTERS, LETTERS * unit / room.pixels);
  const left = (width - unit * (1 + beside)) / 2 + unit * (room.gutter + DATA.edge), pixel = unit / room.pixels;
  const tall = room.radius ? 1 : Math.min(1.4, height / (room.high * unit));  // lanes and field take what room there is
  const x = (share) => left + share * unit, y = (up) => (room.high - up) * unit * tall;
  return {...room, width, height, unit, left, across: unit, letters, pixel, x, y};
}

function fontOf(letters, bold) {
  return `${bold ? "600 " : ""}${letters}px 'Lab Inter', system-ui, sans-serif`;
}

// Labels with these texts, or with their own, by their names.
function writeLabels(pen, place, labels, texts) {
  for (const {name, text: own, x, y, anchor, role, width, size, tone, bold, sign} of labels) {
    const text = own && (texts[name] ?? own);  // what is written nowhere has none of its own
    if (!text) continue;
    const letters = place.letters * size, strong = bold || role === "name", [upright, side] = anchor.split("-"), colour = DATA.colours.tones[strong && tone === "plain" ? "bold" : tone];
    pen.font = fontOf(letters, strong);
    const room = role === "gutter" ? place.gutter * place.unit - 4 : place.width;
    const lines = linesOf(pen, text, width ? Math.min(room, 0.53 * letters * width) : room, sign ? 1.3 * letters : 0), step = 1.3 * letters;
    const long = Math.max(...lines.map((line) => pen.measureText(line).width)) + (sign ? 1.3 * letters : 0), high = step * lines.length;
    const left = Math.min(Math.max(place.x(x) - long * SHARES[side], 2), place.width - long - 2), top = place.y(y) - high * SHARES[upright];
    if (role === "silence" || role === "place" || role === "chip") {
      pen.fillStyle = "#fff";
      pen.fillRect(left - 4, top - 1, long + 8, high + 2);
    }
    if (sign) drawSign(pen, sign, tone === "plain" ? DATA.colours.dot : colour, left, top + step / 2, letters);
    const start = sign ? left + 1.3 * letters : left, room_for = sign ? long - 1.3 * letters : long;
    lines.forEach((line, k) => words(pen, line, start + room_for * SHARES[side], top + step * (k + 0.5), side, "middle", colour));
  }
  pen.font = fontOf(place.letters);
}

// What a label explains looks like this.
function drawSign(pen, sign, colour, x, y, letters) {
  Object.assign(pen, {fillStyle: colour, strokeStyle: colour, lineWidth: sign === "line" ? 2.5 : 1.75});
  if (sign === "line") return stroke(pen, [[x, y], [x + letters, y]]);
  if (sign === "dot") return disc(pen, x + 0.5 * letters, y, 0.18 * letters);
  ring(pen, x + 0.5 * letters, y, 0.36 * letters, 1.75);
}

function ring(pen, x, y, radius, wide) {
  pen.lineWidth = wide;
  pen.beginPath();
  pen.arc(x, y, radius, 0, 7);
  pen.stroke();
}

function disc(pen, x, y, radius) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 7);
  pen.fill();
}

// A text at a place.
function words(pen, text, x, y, align = "left", baseline = "alphabetic", colour = "#15171c") {
  Object.assign(pen, {fillStyle: colour, textAlign: align, textBaseline: baseline});
  pen.fillText(text, x, y);
}

// A text in lines no longer than there is room for.
function linesOf(pen, text, room, beside = 0) {
  const lines = [""];
  for (const word of text.split(" ")) {
    const longer = `${lines[lines.length - 1]} ${word}`.trim();
    if (pen.measureText(longer).width + beside <= room || !lines[lines.length - 1]) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines;
}

function stroke(pen, points) {
  pen.beginPath();
  points.forEach(([x, y], k) => k ? pen.lineTo(x, y) : pen.moveTo(x, y));
  pen.stroke();
}
