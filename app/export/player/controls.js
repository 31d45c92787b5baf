// Sliders over the lattice of recorded runs, and choices of what is looked at; play, pause and the time.

const SPEEDS = [0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1, 2, 5];

function buildControls() {
  const {plan, view} = stage, box = document.getElementById("sliders");
  box.replaceChildren(...plan.axes.map((axis, k) => axis.field === "method" ? chooser(axis, k) : slider(axis, k)));
  const quantities = plan.quantities.map((key) => [key, `${DATA.quantities[key].noun} ${DATA.quantities[key].symbol}`]);
  const looks = [select(tr("Error of"), quantities, "quantity")];
  if (plan.estimators.length > 1) looks.push(select(tr("On the stage"), plan.estimators.map((name) => [name, name]), "estimator"));
  if (plan.magnifies) looks.push(select(tr("Magnify error"), DATA.magnifications.map((factor) => [factor, `× ${factor}`]), "magnified"));
  looks.push(select(tr("Colours"), [[false, tr("linear")], [true, tr("logarithmic")]], "logarithmic"));
  if (plan.compares) looks.push(select(tr("Compare"), DATA.compare.map((name, k) => [k === 1, name]), "difference"));
  if (plan.outlines) looks.push(select(tr("Domains"), [[true, tr("outlined")], [false, tr("not outlined")]], "domains"));
  const speeds = [...new Set([...SPEEDS, view.speed])].sort((a, b) => a - b);
  if (!plan.keeps_its_speed) looks.push(select(tr("Speed"), speeds.map((speed) => [speed, tr("{speed} periods/s", {speed: number(speed)})]), "speed"));
  document.getElementById("looks").replaceChildren(...looks);
  document.getElementById("reach").textContent = plan.axes.length
    ? tr("This file holds {count} recorded runs: the sliders go from one to another.", {count: plan.runs.filter((run) => typeof run !== "string").length}) : "";
}

function labelled(name, ...widgets) {
  const made = element("label", "", {className: "control"});
  made.append(element("span", name), ...widgets);
  return made;
}

function slider(axis, k) {
  const told = element("output", axis.says[axis.start]);
  const range = element("input", "", {type: "range", min: 0, max: axis.values.length - 1, step: 1, value: axis.start});
  range.setAttribute("aria-valuetext", axis.says[axis.start]);
  range.addEventListener("input", () => {
    stage.chosen[k] = +range.value;
    told.textContent = axis.says[range.value];
    range.setAttribute("aria-valuetext", axis.says[range.value]);
    choose();
  });
  return labelled(axis.label, range, told);
}

function chooser(axis, k) {
  const made = element("select");
  made.append(...axis.says.map((name, at) => element("option", name, {value: at, selected: at === axis.start})));
  made.addEventListener("change", () => {
    stage.chosen[k] = +made.value;
    choose();
  });
  return labelled(axis.label, made);
}

// A choice of what is looked at, which is kept in the view under a name.
function select(name, choices, field) {
  const made = element("select");
  made.append(...choices.map(([value, text], at) => element("option", text, {value: at, selected: value === stage.view[field]})));
  made.addEventListener("change", () => {
    stage.view[field] = choices[+made.value][0];
    changed();
  });
  return labelled(name, made);
}

const playing = document.getElementById("play"), timeline = document.getElementById("time");
playing.addEventListener("click", () => setPlaying(!stage.playing));
timeline.addEventListener("input", () => {
  if (!stage.run) return;
  stage.playing = false;
  stage.time = stage.run.tracks.time.values[+timeline.value];
  changed();
});

stage.onChange.push(() => {
  if (!stage.run) return;
  const at = Math.floor(pictureAt(stage.run, stage.time));
  playing.textContent = stage.playing ? tr("Pause") : stage.time >= endOf(stage.run) ? tr("Again") : tr("Play");
  timeline.max = stage.run.tracks.time.rows - 1;
  timeline.value = at;
  timeline.setAttribute("aria-valuetext", `${number(stage.time)} s`);
  put(document.getElementById("clock"), `${number(stage.time, 4)} s`);
});
