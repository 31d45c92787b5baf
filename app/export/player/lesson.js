// The lesson: one step at a time beside the stage, a prediction before what it is about runs.

const KINDS = {predict: tr("Predict"), run: tr("Run"), observe: tr("Observe"), explain: tr("Explain")};
const SIGNS = {true: ["right", tr("✓ right")], false: ["wrong", tr("✗ not so")], null: ["unmarked", ""]};
const lessonBox = document.getElementById("lesson");
let shownAt = 0;

function openLesson() {
  progress = restored();
  showStep();
}

function go(by) {
  goTo(stepBeside(progress.step, by));
}

function goTo(step) {
  progress.step = step;
  keep();
  showStep();
  lessonBox.scrollTop = 0;
  if (window.scrollY > lessonBox.offsetTop) lessonBox.scrollIntoView();
  goOnAt(lessonBox.querySelector("h2") ?? document.getElementById("where"));
}

// The focus goes on with the reader: what had it is there no more.
function goOnAt(place) {
  place.tabIndex = -1;
  place.focus({preventScroll: true});
}

function showStep() {
  shownAt = performance.now();
  const at = progress.step, total = LESSON.steps.length, where = element("p", whereSaid(), {id: "where", tabIndex: -1});
  const bar = element("progress", "", {max: walked().length + 1, value: howFar(at)});
  bar.setAttribute("aria-label", tr("progress"));
  lessonBox.replaceChildren(where, bar, ...(at === 0 ? introduction() : at <= total ? stepParts(LESSON.steps[at - 1]) : ending()));
}

// Words of the lesson, which may be in another language than the file.
const ofLesson = (tag, text, properties = {}) => element(tag, text, {lang: LESSON.language, ...properties});

// What the lesson's author has written, which is html already; nothing that a student writes comes here.
function written(html) {
  const box = ofLesson("div", "", {className: "text"});
  box.innerHTML = html;
  for (const table of box.querySelectorAll("table")) {
    const scroll = element("div", "", {className: "scroll", tabIndex: 0});
    table.replaceWith(scroll);
    scroll.append(table);
  }
  for (const asked of box.querySelectorAll("li strong")) if (asked.textContent === LESSON.asks) asked.replaceWith(budgetButton());
  return box;
}

// As on the live page; the chart is here with the run, below the readout.
function budgetButton() {
  const button = element("button", DATA.budget.question, {type: "button"});
  button.addEventListener("click", () => document.getElementById("budget").scrollIntoView());
  return button;
}

function introduction() {
  const goals = element("ul"), name = element("input", "", {type: "text", value: progress.name, maxLength: LESSON.longest_name, autocomplete: "off"});
  goals.append(...LESSON.goals.map((goal) => ofLesson("li", goal)));
  name.disabled = keeper.name !== "" || Object.keys(progress.answers).length > 0;  // its numbers are those of the answers
  name.addEventListener("input", () => {
    progress.name = [...name.value.trim()].slice(0, LESSON.longest_name).join("");
    keep();
    text.replaceWith(text = written(own(LESSON.intro)));
  });
  let text = written(own(LESSON.intro));
  const parts = [element("p", takes()), goals];
  if (LESSON.needs.length) parts.push(element("p", tr("Do before: {lessons}.", {lessons: LESSON.needs.join("; ")})));
  if (LESSON.language !== document.documentElement.lang) parts.unshift(element("p", tr("This lesson is in English."), {className: "elsewhere"}));
  if (LESSON.elsewhere.length) parts.push(element("p", tr("This file shows recorded runs. Instructions about {controls} need the live page.",
    {controls: LESSON.elsewhere.join(", ")}), {className: "elsewhere"}));
  return [...parts, text, field(tr("Your name"), name), element("p", keeper.hint, {className: "hint"}), ...coreChoice(), moves(false, true)];
}

function stepParts(step) {
  const heading = element("h2"), kind = element("span", KINDS[step.kind], {className: step.kind});
  const deeper = step.core ? [] : [element("span", tr("deeper"), {className: "deeper"}), " "];
  heading.append(kind, " ", ...deeper, ofLesson("b", own(step.title), {className: "title"}));
  const parts = [heading];
  if (step.kind === "explain") parts.push(compared(askedBefore(step)), ...(step.bets.length ? [betsFigure(bettorsOf(step))] : []));
  parts.push(written(own(step.html)));
  if (step.stage) parts.push(stageButton(step));
  return [...parts, ...(step.question ? asking(step) : [moves(true, true)]), ...(step.core ? [] : [skipDeeper()])];
}

function stageButton(step) {
  const button = element("button", tr("▶ On the stage"), {type: "button", className: "stage"});
  button.addEventListener("click", async () => {
    await putOnStage(own(step.stage), true);
    if (window.matchMedia("(max-width: 1000px)").matches) document.getElementById("scene").scrollIntoView({behavior: "smooth"});
  });
  return button;
}

function asking(step) {
  const {question} = step, answered = progress.answers[step.key], fixed = step.kind === "predict" && answered !== undefined;
  const [widget, value] = answerWidget(question, answered?.last, fixed);
  const said = element("div", "", {className: "recorded", hidden: true});
  said.setAttribute("role", "status");
  const take = element("button", step.kind === "predict" ? tr("Record my prediction") : tr("Check my answer"), {type: "button", disabled: fixed});
  const onward = moves(true, answered !== undefined);
  if (answered) tellTaken(step, said, false);
  take.addEventListener("click", () => {
    const answer = value(), why = trouble(question, answer);
    if (why) {
      said.hidden = false;
      said.textContent = why;
      return;
    }
    record(step.key, answer, (performance.now() - shownAt) / 1000);
    shownAt = performance.now();
    if (step.kind === "predict") {
      showStep();
      return goOnAt(lessonBox.querySelector(".recorded"));
    }
    tellTaken(step, said, true);
    onward.querySelector(".next").disabled = false;
  });
  return [widget, take, said, onward];
}

// What is said of the answer that a step has: of a prediction nothing but that it is recorded.
function tellTaken(step, box, checked) {
  const answer = progress.answers[step.key], found = checked ? mark(step.question, answer.last) : {right: null, told: ""};
  const [kind, sign] = SIGNS[found ? found.right : null];
  const comment = step.kind === "predict" ? tr("It is recorded; now see what happens.")
    : !found ? tr("It could not be checked.") : found.right !== false ? ""
    : answer.attempts >= LESSON.told_after ? tr("It is {answer}.", {answer: found.told}) : tr("Look again, and try once more.");
  box.hidden = false;
  const said = step.question.kind === "choice" ? ofLesson : element;
  box.replaceChildren(tr("Your answer:"), " ", said("b", shown(step.question, answer.last)), " ", element("span", sign, {className: kind}), " ", comment);
}

// The steps with questions since the explanation before a step.
function askedBefore(step) {
  const found = [];
  for (let k = LESSON.steps.indexOf(step) - 1; k >= 0 && LESSON.steps[k].kind !== "explain"; k--)
    if (LESSON.steps[k].question) found.unshift(LESSON.steps[k]);
  return found;
}

// Each answer, as first given, beside what came out.
function compared(steps) {
  const box = element("div", "", {className: "scroll", tabIndex: 0});
  const rows = steps.filter((step) => progress.answers[step.key]).map((step) => {
    const answer = progress.answers[step.key].first, found = mark(step.question, answer), line = element("tr");
    const [kind, sign] = SIGNS[found ? found.right : null];
    const told = !found ? tr("could not be checked") : found.score === undefined ? found.told : fill(BETS.scored, {told: found.told, score: fixed(found.score, 2)});
    const came = step.question.kind === "text" ? tr("for your teacher") : told;
    const cell = step.question.kind === "choice" ? ofLesson : element;
    line.append(ofLesson("th", own(step.title), {scope: "row"}), cell("td", shown(step.question, answer)), cell("td", came),
      element("td", sign, {className: kind}));
    return line;
  });
  const table = element("table", "", {className: "compared"}), head = element("tr");
  head.append(element("td"), ...[tr("you said"), tr("came out")].map((name) => element("th", name, {scope: "col"})), element("td"));
  if (rows.length) table.append(head, ...rows);
  box.append(table);
  return rows.length ? box : "";
}

function ending() {
  const asked = LESSON.steps.filter((step) => step.question);
  const missing = walked().filter((step) => step.question && !progress.answers[step.key]).length;
  const button = element("button", tr("Hand in"), {type: "button", title: tr("save your answers as a file")});
  button.addEventListener("click", handIn);
  const left = missing === 1 ? tr("1 question is still open; go back to answer.") : tr("{count} questions are still open; go back to answer.", {count: missing});
  return [element("h2", tr("The end")), ...missing ? [element("p", left)] : [], compared(asked),
    element("p", keeper.handed),
    button, ...wayDeeper(), moves(true, false), again()];
}

function again() {
  const button = element("button", tr("Begin anew"), {type: "button", className: "again"});
  button.addEventListener("click", () => {
    if (!window.confirm(keeper.forget)) return;
    progress = begun();
    keep();
    showStep();
    goOnAt(document.getElementById("where"));
  });
  return button;
}

function moves(back, onward) {
  const box = element("div", "", {className: "moves"});
  for (const [name, by, can, kind] of [[tr("← Back"), -1, back, "back"], [tr("Next →"), 1, onward, "next"]]) {
    const button = element("button", name, {type: "button", disabled: !can, className: kind});
    button.addEventListener("click", () => go(by));
    box.append(button);
  }
  return box;
}
