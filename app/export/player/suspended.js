// What a student has done in at most 4096 printable ASCII characters, as SCORM 1.2 keeps them.

const CHARACTERS = 4096;
const NOT_PLAIN = /[^\x20-\x7e]+/g;

// Other letters as base 64 of their 16 bits each, between & and -, as in names of mailboxes (RFC 3501).
function plainLetters(text) {
  return text.replaceAll("&", "&-").replace(NOT_PLAIN, (run) => {
    const bytes = [...Array(run.length)].map((_, k) => String.fromCharCode(run.charCodeAt(k) >> 8, run.charCodeAt(k) & 255));
    return `&${btoa(bytes.join("")).replace(/=+$/, "")}-`;
  });
}

function allLetters(text) {
  return text.replace(/&([^-]*)-/g, (_, packed) => {
    const bytes = atob(packed), units = [...Array(bytes.length >> 1)];
    return packed ? String.fromCharCode(...units.map((_, k) => 256 * bytes.charCodeAt(2 * k) + bytes.charCodeAt(2 * k + 1))) : "&";
  });
}

const askedSteps = () => LESSON.steps.filter((step) => step.question);

// Progress as a text, and the steps of whose answers that does not have everything: where there is no room, texts lose what
// was written first, and then the longest answers go.
function suspended(progress) {
  const short = new Set();
  let kept = askedSteps().flatMap((step, k) => {
    const answer = progress.answers[step.key];
    return answer ? [{step, row: [k, answer.last, answer.attempts, answer.seconds, ...same(answer.first, answer.last) ? [] : [answer.first]]}] : [];
  });
  const written = () => plainLetters(JSON.stringify([LESSON.fingerprint.slice(0, 16), progress.name, +progress.core, ...kept.map(({row}) => row)]));
  const longestFirst = () => [...kept].sort((one, other) => size(other.row) - size(one.row));
  for (const one of longestFirst().filter(({step, row}) => step.question.kind === "text" && row.length > 4)) {
    if (written().length <= CHARACTERS) break;
    one.row.pop();
    short.add(one.step);
  }
  for (const one of longestFirst()) {
    if (written().length <= CHARACTERS) break;
    kept = kept.filter((other) => other !== one);
    short.add(one.step);
  }
  return {text: written(), short: [...short]};
}

const same = (one, other) => JSON.stringify(one) === JSON.stringify(other);
const size = (row) => plainLetters(JSON.stringify(row)).length;

// Progress from such a text; null where it is of another lesson.
function resumed(text, step) {
  const [fingerprint, name, core, ...rows] = JSON.parse(allLetters(text)), asked = askedSteps();
  if (!LESSON.fingerprint.startsWith(fingerprint)) return null;
  const answers = rows.map(([k, last, attempts, seconds, first = last]) => [asked[k].key, {first, last, attempts, seconds}]);
  return {schema: LESSON.schema, lesson: LESSON.name, fingerprint: LESSON.fingerprint, name, step, answers: Object.fromEntries(answers), core: core === 1};
}
