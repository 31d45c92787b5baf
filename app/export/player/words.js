// What the file says, in its language: words of the scripts stand in them in English. A text may have places, {name}.
const tr = (text, values = {}) => fill(DATA.words[text] || text, values);

const {number, fixed, whole, withUnit, ratio, perCent, powerText, powerOfTen, prefixes: PREFIXES, nothing: NOTHING} = numbers;

// A number in one of these forms, where there is one.
const known = (value, form, ...more) => Number.isFinite(value) ? form(value, ...more) : NOTHING;

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

function put(box, text) {
  if (box.textContent !== text) box.textContent = text;
}

function tableRow(...texts) {
  const made = document.createElement("tr");
  made.append(...texts.map((text, k) => element(k ? "td" : "th", text)));
  return made;
}
