// SHA-256, for a variant is drawn by it; the browser's own is not there in a page that comes from a file.

const ROOTS = [], FRACTIONS = [];
for (let candidate = 2; FRACTIONS.length < 64; candidate++) {
  let prime = true;
  for (let k = 2; k * k <= candidate; k++) prime = prime && candidate % k > 0;
  if (!prime) continue;
  const fraction = (root) => Math.floor((root - Math.floor(root)) * 2 ** 32) | 0;
  if (ROOTS.length < 8) ROOTS.push(fraction(Math.sqrt(candidate)));
  FRACTIONS.push(fraction(Math.cbrt(candidate)));
}

// The digest of bytes, as eight numbers of 32 bits.
function sha256(bytes) {
  const length = ((bytes.length + 72) >> 6) << 6, padded = new DataView(new ArrayBuffer(length)), state = [...ROOTS];
  bytes.forEach((byte, k) => padded.setUint8(k, byte));
  padded.setUint8(bytes.length, 128);
  padded.setUint32(length - 4, 8 * bytes.length);
  for (let start = 0; start < length; start += 64) {
    const sums = scrambled(padded, start, state);
    for (let k = 0; k < 8; k++) state[k] = (state[k] + sums[k]) | 0;
  }
  return state.map((part) => part >>> 0);
}

function scrambled(padded, start, state) {
  const turned = (word, by) => (word >>> by) | (word << (32 - by)), words = [];
  let [a, b, c, d, e, f, g, h] = state;
  for (let k = 0; k < 64; k++) {
    if (k < 16) words[k] = padded.getInt32(start + 4 * k);
    else {
      const early = words[k - 15], late = words[k - 2];
      words[k] = (words[k - 16] + (turned(early, 7) ^ turned(early, 18) ^ (early >>> 3)) + words[k - 7]
        + (turned(late, 17) ^ turned(late, 19) ^ (late >>> 10))) | 0;
    }
    const first = (h + (turned(e, 6) ^ turned(e, 11) ^ turned(e, 25)) + ((e & f) ^ (~e & g)) + FRACTIONS[k] + words[k]) | 0;
    const second = ((turned(a, 2) ^ turned(a, 13) ^ turned(a, 22)) + ((a & b) ^ (a & c) ^ (b & c))) | 0;
    [h, g, f, e, d, c, b, a] = [g, f, e, (d + first) | 0, c, b, a, (first + second) | 0];
  }
  return [a, b, c, d, e, f, g, h];
}
