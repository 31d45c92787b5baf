// The core of a lesson: the rounds that stand by themselves. Whoever takes it alone skips the deeper steps.

// The steps that are taken.
const walked = () => LESSON.steps.filter((step) => step.core || !progress.core);

// How many of the steps that are taken have come, with the one that has this number.
const howFar = (number) => number > LESSON.steps.length ? walked().length + 1 : walked().filter((step) => LESSON.steps.indexOf(step) < number).length;

// The number of the step after this one, or before it; 0 is the introduction, one more than there are is the end.
function stepBeside(at, by) {
  const places = [0, ...walked().map((step) => LESSON.steps.indexOf(step) + 1), LESSON.steps.length + 1];
  return by > 0 ? places.find((place) => place > at) ?? LESSON.steps.length + 1 : places.filter((place) => place < at).pop() ?? 0;
}

function whereSaid() {
  const at = progress.step, place = howFar(at), total = walked().length;
  if (at === 0) return tr("Introduction");
  if (at > LESSON.steps.length) return tr("The end");
  return progress.core ? tr("Step {at} of {total} of the core", {at: place, total}) : tr("Step {at} of {total}", {at: place, total});
}

const hasDeeper = () => LESSON.steps.some((step) => !step.core);

const takes = () => hasDeeper()
  ? tr("{core} minutes for the core, {minutes} in all. Afterwards you can", {core: LESSON.core_minutes, minutes: LESSON.minutes})
  : tr("{minutes} minutes. Afterwards you can", LESSON);

// In the introduction: a box to take the core alone.
function coreChoice() {
  if (!hasDeeper()) return [];
  const line = element("label", "", {className: "only"}), box = element("input", "", {type: "checkbox", checked: progress.core});
  line.append(box, element("span", tr("Core only")));
  box.addEventListener("change", () => {
    progress.core = box.checked;
    keep();
    document.querySelector("#lesson progress").max = walked().length + 1;
  });
  const hint = tr("The core is self-contained and takes {minutes} minutes; you can go deeper at its end.", {minutes: LESSON.core_minutes});
  return [line, element("p", hint, {className: "hint"})];
}

// In a deeper step: a way past it, and past all others.
function skipDeeper() {
  const button = element("button", tr("Core only: skip what is deeper"), {type: "button", className: "again"});
  button.addEventListener("click", () => {
    progress.core = true;
    goTo(stepBeside(progress.step, 1));
  });
  return button;
}

// At the end of the core: what else there is, and the way there.
function wayDeeper() {
  if (!progress.core) return [];
  const deeper = LESSON.steps.filter((step) => !step.core), minutes = Math.max(1, LESSON.minutes - LESSON.core_minutes);
  const button = element("button", tr("Go deeper"), {type: "button"});
  button.addEventListener("click", () => {
    progress.core = false;
    goTo(LESSON.steps.indexOf(deeper[0]) + 1);
  });
  return [element("p", tr("This was the core. The lesson has {steps} deeper steps, some {minutes} minutes.", {steps: deeper.length, minutes})), button];
}
