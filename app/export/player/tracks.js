// Recordings: from the text in the page to tracks of numbers. app/export/recording_compression.py says how they are written.

const KEPT = 12;  // recordings that stay unpacked
const unpacked = new Map();

async function inflated(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new DataView(await new Response(stream).arrayBuffer());
}

// Tracks by their names: values (rows × width), and what each is.
function tracksOf(view, headers) {
  const tracks = {};
  let at = 0;
  for (const {name, kind, rows, width} of headers) {
    const values = new Float32Array(rows * width);
    if (kind === "number") {
      for (let k = 0; k < values.length; k++, at += 4) values[k] = view.getFloat32(at, true);
    } else {
      const scales = new Float32Array(kind === "place" ? 1 : rows);
      for (let k = 0; k < scales.length; k++, at += 4) scales[k] = view.getFloat32(at, true);
      readCodes(view, at, DATA.codes[kind], rows, width, scales, values);
      at += DATA.codes[kind].bytes * values.length;
    }
    tracks[name] = {rows, width, values};
  }
  return tracks;
}

// Codes are kept as differences from the row before, modulo 256 or 65536; the code that no number has is the missing one.
function readCodes(view, at, {top, none, bytes}, rows, width, scales, values) {
  const wide = bytes === 2, all = rows * width, before = new Uint16Array(width);
  for (let row = 0, k = 0; row < rows; row++) {
    const scale = scales[wide ? 0 : row] / top;
    for (let p = 0; p < width; p++, k++) {
      let code = before[p] + view.getUint8(at + k) + (wide ? 256 * view.getUint8(at + all + k) : 0);
      code = before[p] = code & (wide ? 65535 : 255);
      if (none < 0 && code > top) code -= wide ? 65536 : 256;
      values[k] = code === none ? NaN : code * scale;
    }
  }
}

// A run by its number, unpacked.
async function recording(id) {
  if (!unpacked.has(id)) {
    const run = DATA.runs[id];
    const view = await inflated(document.getElementById(`run-${id}`).textContent);
    unpacked.set(id, {id, ...run.head, texts: DATA.texts[run.texts], tracks: tracksOf(view, run.tracks)});
    if (unpacked.size > KEPT) unpacked.delete(unpacked.keys().next().value);
  }
  return unpacked.get(id);
}

// A row of a track, or, between two pictures, what lies between them.
function row(track, at) {
  const low = Math.min(Math.floor(at), track.rows - 1), share = at - low, start = low * track.width;
  const first = track.values.subarray(start, start + track.width);
  if (share <= 0 || low + 1 >= track.rows) return first;
  const second = track.values.subarray(start + track.width, start + 2 * track.width);
  return first.map((value, k) => value + share * (second[k] - value));
}

// Sizes of the true error of a quantity at a picture; null where nobody knows them.
function trueSizes(run, quantity, at) {
  if (run.tracks[`error.${quantity}`]) return row(run.tracks[`error.${quantity}`], at);
  const deviation = run.tracks[`deviation.${quantity}`];
  return run.known && deviation ? row(deviation, at).map(Math.abs) : null;
}

// Sizes of what an estimator says, or of how far it is from the truth; null where it says nothing.
function estimatedSizes(run, quantity, estimator, difference, at) {
  const track = run.tracks[`${difference ? "difference" : "estimate"}.${estimator}.${quantity}`];
  return track && track.values.some(Number.isFinite) ? row(track, at) : null;
}

function largest(values) {
  let found = 0;
  if (values) for (const value of values) if (value > found && Number.isFinite(value)) found = value;
  return found;
}
