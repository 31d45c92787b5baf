// What the page says, in its language: words of the scripts stand in them in English. A text may have places, {name}.
const WORDS = JSON.parse(document.getElementById("lab-words").textContent);
const tr = (text, values = {}) => (WORDS[text] || text).replace(/\{(\w+)\}/g, (place, name) => values[name] ?? place);
// And what the style says (content).
for (const [name, text] of [["drop", tr("Drop a file of particles to judge it and show it here")],
  ["time-step", tr("Time step")], ["compiling", tr("compiling …")], ["price", tr("time")]])
  document.documentElement.style.setProperty(`--says-${name}`, JSON.stringify(text));
