// What a student has done: kept (keeping.js), handed in as a file; and what is right.

const LESSON = DATA.lesson;
let progress = null;

// The number of the variant that a name draws: as app/lessons/lesson.py has it.
function variantOf(name) {
  const folded = [...name.normalize("NFKC")].map((letter) => LESSON.fold[letter] ?? letter.toLowerCase()).join("");
  const spaces = new Set(LESSON.spaces);
  const plain = [...folded].map((letter) => spaces.has(letter) ? " " : letter).join("").split(" ").filter(Boolean).join(" ");
  if (!plain) return 0;
  const [high, low] = sha256(new TextEncoder().encode(`${LESSON.name}\n${plain}`));
  return Number((BigInt(high) * 4294967296n + BigInt(low)) % BigInt(LESSON.variants));
}

// Of things that may differ with the variant, the one of this student.
function own(each) {
  return each.length > 1 ? each[variantOf(progress.name)] : each[0];
}

function begun() {
  return {schema: LESSON.schema, lesson: LESSON.name, fingerprint: LESSON.fingerprint, name: keeper.name, step: 0, answers: {}, core: LESSON.begins_core};
}

function keep() {
  keeper.write(progress);
}

function restored() {
  try {
    const found = keeper.read();
    if (found.schema !== LESSON.schema || found.fingerprint !== LESSON.fingerprint || typeof found.name !== "string") return begun();
    const known = Object.fromEntries(LESSON.steps.filter((step) => step.question).map((step) => [step.key, step.question]));
    for (const [key, given] of Object.entries(found.answers))
      if (!known[key] || trouble(known[key], given.first) || trouble(known[key], given.last)) return begun();
    found.core = found.core === true && hasDeeper();
    found.step = Math.min(Math.max(found.step | 0, 0), LESSON.steps.length + 1);
    return found;
  } catch {
    return begun();
  }
}

function record(key, given, seconds) {
  const before = progress.answers[key] || {first: given, attempts: 0, seconds: 0};
  progress.answers[key] = {first: before.first, last: given, attempts: before.attempts + 1,
    seconds: Math.round(10 * (before.seconds + seconds)) / 10};
  keeper.answered(key, given, seconds);
  keep();
}

function handIn() {
  const called = progress.name.replace(/[^\p{L}\p{N}_-]+/gu, "-").replace(/^-+|-+$/g, "") || "answers";
  const link = element("a", "", {download: `${LESSON.name}-${called}.json`,
    href: URL.createObjectURL(new Blob([JSON.stringify(progress)], {type: "application/json"}))});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// Why something is no answer to a question, in words; "" where it is one.
function trouble(question, answer) {
  const real = (value) => typeof value === "number" && Number.isFinite(value) && Math.abs(value) < LESSON.most;
  if (question.kind === "text")
    return typeof answer === "string" && answer.trim() && [...answer].length <= LESSON.longest ? "" : tr("Please write one to {most} characters.", {most: LESSON.longest});
  if (question.kind === "choice")
    return Number.isInteger(answer) && answer >= 1 && answer <= question.options[0].length ? "" : tr("Please choose one of the answers.");
  if (question.kind === "interval") {
    if (!Array.isArray(answer) || answer.length !== 2 || !answer.every(real)) return tr("Please give two numbers, the least and the most.");
    if (answer[0] > answer[1]) return tr("The first number must not be above the second.");
    return answer[0] > 0 ? "" : tr("Please give two numbers above 0: bets are scored by factors, so 0 is not possible.");
  }
  return real(answer) ? "" : tr("Please give a number.");
}

// Whether an answer is right (null: nobody marks it), and what is, in words; null where it could not be found out.
function mark(question, answer) {
  const rule = own(question.rules);
  if (!rule) return null;
  if (question.kind === "text") return {right: null, told: ""};
  if (rule.options) return {right: rule.options.includes(answer), told: rule.told};
  if (typeof rule.value === "string") return {right: answer === rule.value, told: rule.told};
  if (question.kind === "interval") {
    const bet = betOf(answer, rule.value, question.level);
    return {right: bet.holds, told: rule.told, score: bet.score};
  }
  return {right: Math.abs(answer - rule.value) <= rule.tolerance * Math.abs(rule.value), told: rule.told};
}

// An answer in words.
function shown(question, answer) {
  if (question.kind === "choice") return own(question.options)[answer - 1];
  if (question.kind === "interval") return tr("{low} to {high}", {low: inUnit(answer[0], question.unit), high: inUnit(answer[1], question.unit)});
  return question.kind === "text" ? answer : inUnit(answer, question.unit);
}

// A value in words, as app/lessons/answer_marking.py has it.
function inUnit(value, unit) {
  return LESSON.bare.includes(unit) ? withUnit(value, unit, LESSON.digits) : `${number(value, LESSON.digits)} ${unit}`.trim();
}
