// A lesson in a course: its system is told by SCORM 1.2 what a student has done, and says so again when they come back.

const PATIENCE = 5000, PAUSE = 200;  // milliseconds until it is said that there is no system, and between looks for one
const early = [];  // answers that no system has
const answered = (...answer) => early.push(answer);
const local = {...keeper, answered};
const course = {open: false, told: 0, best: 0, finished: false, began: performance.now()};  // told: interactions
let call = null;
const said = element("p", "", {id: "course"});
said.setAttribute("role", "status");
document.querySelector("header").append(said);

const heard = (name) => call("LMSGetValue", `cmi.${name}`);
// Whether the system takes a value, or another form of it.
const tell = (name, ...values) => values.some((value) => call("LMSSetValue", `cmi.${name}`, value) === "true");
const isDone = (status) => status === "completed" || status === "passed";

// A system may come late. Until then the answers of whoever sat here before are not theirs.
keeper = {...local, read: () => null, write: () => {}};
lookForCourse(window.parent === window && !window.opener ? 0 : PATIENCE);

function lookForCourse(wait) {
  const api = apiOfCourse();
  if (!api) setTimeout(lookForCourse, PAUSE, wait - PAUSE);
  if (!api && wait !== 0) return;
  keeper = local;
  said.textContent = api ? "" : tr("Opened outside a course: your answers are not reported.");
  call = api && callOf(api);
  if (api && call("LMSInitialize", "") === "true") enterCourse();
  else if (api) said.textContent = tr("The course's system did not start this lesson and gets no answers; open the lesson again from the course.");
  if (progress) catchUp();
}

// Goes on with what is known of earlier visits, and adds what was answered since this one began. A name counts as it was
// when there were answers, to its numbers.
function catchUp() {
  const before = progress, answers = early.splice(0);
  progress = restored();
  const known = Object.keys(progress.answers);
  if (answers.length && !known.length) Object.assign(progress, {name: before.name, core: before.core});
  progress.step = Math.max(progress.step, before.step);
  if (variantOf(progress.name) === variantOf(before.name))
    for (const [key, ...given] of answers) if (!known.includes(key)) record(key, ...given);
  if (JSON.stringify(progress) !== JSON.stringify(before)) showStep();
}

function enterCourse() {
  const mode = heard("core.lesson_mode"), status = heard("core.lesson_status");
  course.open = mode === "" || mode === "normal";
  course.told = Number(heard("interactions._count")) || 0;
  course.finished = isDone(status);
  course.best = course.finished ? Number(heard("core.score.raw")) || 0 : 0;
  keeper = {
    name: [...heard("core.student_name").trim()].slice(0, LESSON.longest_name).join(""),
    hint: tr("It gives you your own numbers. Answers, times and a score go to your course's system."),
    handed: tr("Your course's system has your answers, times and score. Hand in saves the answers as a file as well."),
    forget: tr("Delete your answers and start again? Your course keeps the results that it already has."),
    read: remembered, write: report, answered: reportAnswer,
  };
  if (!course.open) said.textContent = tr("Opened for review: new answers are not saved.");
  else if (!course.finished) tell("core.lesson_status", "incomplete");
  window.addEventListener("pagehide", leaveCourse);
  window.addEventListener("pageshow", (event) => event.persisted && location.reload());  // that visit has been ended
}

// What the system has from an earlier visit. A name counts as it was when there were answers: their numbers are its.
function remembered() {
  const text = heard("suspend_data");
  if (!text) return null;
  const found = resumed(text, Number(heard("core.lesson_location")));
  if (!found) said.textContent = tr("This lesson has changed since your last visit and starts again.");
  else if (!Object.keys(found.answers).length && keeper.name) found.name = keeper.name;
  return found;
}

function report(progress) {
  if (!course.open) return;
  const {text, short} = suspended(progress), taken = tell("suspend_data", text);
  tell("core.lesson_location", String(progress.step));
  reportScore(progress);
  tell("core.session_time", timespan((performance.now() - course.began) / 1000));
  const titles = short.map((step) => tr('"{name}"', {name: own(step.title)})).join(", ");
  said.textContent = !taken || call("LMSCommit", "") !== "true"
    ? tr("Your course's system did not save your last answers; Hand in, at the end, saves them as a file.")
    : short.length ? tr("Your course's system saves only {most} characters, so your text at {titles} is cut; Hand in, at the end, saves all of it.",
      {most: CHARACTERS, titles}) : "";
}

// Completed, and never passed or failed: predictions are there to go wrong. A score that counts stays when one begins anew,
// or goes deeper than the core.
function reportScore(progress) {
  const asked = walked().filter((step) => step.question), marked = asked.filter((step) => step.question.kind !== "text" && own(step.question.rules));
  const right = marked.reduce((sum, step) => sum + (step.key in progress.answers ? credit(step.question, progress.answers[step.key].last) : 0), 0);
  const raw = Math.round(10000 * right / (marked.length || 1)) / 100;
  if (!course.finished && progress.step > LESSON.steps.length && asked.every((step) => step.key in progress.answers)) {
    course.finished = true;
    tell("core.lesson_status", "completed");
  }
  if (course.finished) course.best = Math.max(course.best, raw);
  if (!marked.length) return;
  tell("core.score.min", "0");
  tell("core.score.max", "100");
  tell("core.score.raw", decimal(Math.max(raw, course.best)));
}

// How much of a right answer one is; of an interval by its score, as app/lessons/grading.py has it.
function credit(question, answer) {
  const {right, score} = mark(question, answer);
  return score === undefined ? +right : Math.max(0, 1 - score / 2);
}

// An interaction for each answer, the wrong ones too.
function reportAnswer(key, answer, seconds) {
  if (!course.open) return;
  const {question} = LESSON.steps.find((step) => step.key === key), found = mark(question, answer), [type, forms] = interaction(question, answer);
  const part = (name, ...values) => tell(`interactions.${course.told}.${name}`, ...values);
  if (!part("id", key)) return;  // not every system has them
  part("type", type);
  part("time", new Date().toTimeString().slice(0, 8));
  part("student_response", ...forms);
  part("result", found?.right === true ? "correct" : found?.right === false ? "wrong" : "neutral");
  part("latency", timespan(seconds));
  course.told++;
}

function leaveCourse() {
  if (!call) return;
  if (course.open) {
    tell("core.session_time", timespan((performance.now() - course.began) / 1000));
    tell("core.exit", "suspend");  // also of a completed lesson: who comes back sees what was answered
    call("LMSCommit", "");
  }
  course.open = false;
  call("LMSFinish", "");
  window.removeEventListener("pagehide", leaveCourse);
}
