// What the file says, in its language: words of the scripts stand in them in English. A text may have places, {name}.
const tr = (text, values = {}) => fill(DATA.words[text] || text, values);

// Numbers as they go into a sentence: to the letter the forms of app/names_and_units.py, with the limits that it gives.

const {prefixes: PREFIXES, superscripts: SUPERSCRIPTS, ratios: PLAIN_RATIOS, percents: PERCENTS, powers: PLAIN_POWERS, nothing: NOTHING} = DATA.formats;

// What toFixed or toExponential writes, but what lies midway between two goes to the even one, as in Python.
function rounded(value, form, places) {
  const [exact, power] = value[form](40).split("e"), point = exact.indexOf("."), cut = exact.slice(0, point + (places && places + 1));
  const midway = /^50*$/.test(exact.slice(point + 1 + places)) && "02468".includes(cut.slice(-1));
  return !midway ? value[form](places) : power ? `${cut}e${power}` : cut;
}

// So many decimals: Python's "f", below 1e21.
function fixed(value, places) {
  return Number.isFinite(value) ? (Object.is(value, -0) ? "-" : "") + rounded(value, "toFixed", places) : number(value);
}

// So many digits, an exponent only for what is very large or small: Python's "g".
function number(value, digits = 3) {
  if (!Number.isFinite(value)) return {NaN: "nan", Infinity: "inf", "-Infinity": "-inf"}[value];
  if (value === 0) return Object.is(value, -0) ? "-0" : "0";
  const [mantissa, power] = rounded(value, "toExponential", digits - 1).split("e");
  const plain = (text) => text.includes(".") ? text.replace(/\.?0+$/, "") : text;
  if (+power >= -4 && +power < digits) return plain(Number(`${mantissa}e${power}`).toFixed(Math.max(0, digits - 1 - power)));
  return `${plain(mantissa)}e${power[0]}${power.slice(1).padStart(2, "0")}`;
}

// A size with its unit and a prefix that keeps it short: 2.1 mm, 340 kPa.
function withUnit(value, unit, digits = 3) {
  if (!Number.isFinite(value) || value === 0) return `${number(value)} ${unit}`;
  const short = rounded(value, "toExponential", digits - 1);
  const third = Math.floor(Math.floor(Math.log10(Math.abs(Number(short)))) / 3);
  if (!(third in PREFIXES)) return `${short} ${unit}`;
  return `${number(Number(number(value / 1000 ** third, digits)), 6)} ${PREFIXES[third]}${unit}`;
}

// An estimate over what it is an estimate of: 0.36, 1.02, 6 × 10⁴.
function ratio(value) {
  if (PLAIN_RATIOS[0] < value && value < PLAIN_RATIOS[1]) return fixed(value, 2);
  const [digits, power] = number(value, 1).split("e");
  return power ? `${digits} × ${powerText(+power).trim()}` : digits;
}

// A share to two digits: 0.29 %, 6.4 %, 53 %, 2,300 %.
function perCent(share) {
  const percent = 100 * share, [least, most, whole] = PERCENTS;
  if (percent >= whole && percent < most) return `${fixed(percent, 0).replace(/\B(?=(\d{3})+$)/g, ",")} %`;
  return `${percent === 0 || (percent > least && percent < most) ? number(percent, 2) : ratio(percent)} %`;
}

// A number in one of these forms, where there is one.
const known = (value, form, ...more) => Number.isFinite(value) ? form(value, ...more) : NOTHING;

function powerText(power) {
  return power === 0 ? "" : "10" + [...String(power)].map((sign) => SUPERSCRIPTS[sign]).join("") + " ";
}

// The power of ten to take out of numbers up to the largest.
function powerOfTen(largest) {
  const power = largest > 0 && largest < Infinity ? Math.floor(Math.log10(largest)) : 0;
  return PLAIN_POWERS[0] <= power && power <= PLAIN_POWERS[1] ? 0 : power;
}

// The next of some steps times a power of ten, and that step.
function roundUp(value, steps) {
  const power = 10 ** Math.floor(Math.log10(value));
  for (const step of steps) if (value <= step * power * (1 + 1e-12)) return [step * power, step];
  return [10 * power, 1];
}

// A text with numbers in the places of their names in braces.
function fill(text, numbers) {
  return text.replace(/\{(\w+)\}/g, (place, name) => numbers[name] ?? place);
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
