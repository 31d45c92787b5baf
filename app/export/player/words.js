// Numbers as they go into a sentence; the same forms as app/words.py.

const PREFIXES = {"-4": "p", "-3": "n", "-2": "µ", "-1": "m", 0: "", 1: "k", 2: "M", 3: "G"};
const SUPERSCRIPTS = {"-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹"};

// So many digits, an exponent only for what is very large or small: Python's "g".
function number(value, digits = 3) {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "–" : String(value);
  if (value === 0) return "0";
  const [mantissa, power] = value.toExponential(digits - 1).split("e");
  const plain = (text) => text.includes(".") ? text.replace(/\.?0+$/, "") : text;
  if (+power >= -4 && +power < digits) return plain(Number(`${mantissa}e${power}`).toFixed(Math.max(0, digits - 1 - power)));
  return `${plain(mantissa)}e${power[0]}${power.slice(1).padStart(2, "0")}`;
}

// A size with its unit and a prefix that keeps it short: 2.1 mm, 340 kPa.
function withUnit(value, unit, digits = 3) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return `0 ${unit}`;
  const third = Math.floor(Math.log10(Math.abs(Number(value.toPrecision(digits)))) / 3);
  if (!(third in PREFIXES)) return `${value.toExponential(digits - 1)} ${unit}`;
  return `${number(Number((value / 1000 ** third).toPrecision(digits)), 6)} ${PREFIXES[third]}${unit}`;
}

// An estimate over what it is an estimate of: 0.36, 1.02, 6 × 10⁴.
function ratio(value) {
  if (!Number.isFinite(value)) return "–";
  if (value > 0.095 && value < 1000) return value.toFixed(2);
  if (value === 0) return "0";
  const [digits, power] = value.toExponential(0).split("e");
  return `${digits} × ${powerText(+power).trim()}`;
}

function powerText(power) {
  return power === 0 ? "" : "10" + [...String(power)].map((sign) => SUPERSCRIPTS[sign]).join("") + " ";
}

// The power of ten to take out of numbers up to the largest.
function powerOfTen(largest) {
  const power = largest > 0 ? Math.floor(Math.log10(largest)) : 0;
  return power < -1 || power > 3 ? power : 0;
}

// The next of some steps times a power of ten, and that step.
function roundUp(value, steps) {
  const power = 10 ** Math.floor(Math.log10(value));
  for (const step of steps) if (value <= step * power * (1 + 1e-12)) return [step * power, step];
  return [10 * power, 1];
}

function capital(text) {
  return text.slice(0, 1).toUpperCase() + text.slice(1);
}

// An element with a text, which is never read as html, and with what else it has.
function element(tag, text = "", properties = {}) {
  const made = document.createElement(tag);
  made.textContent = text;
  return Object.assign(made, properties);
}
