// A course's system as SCORM 1.2 has it, to the letter: types, lengths, what may be read and written, error codes. Only what
// has been committed is there at the next visit. ``system.faults`` are the calls that it refused.

const text = (most) => (value) => new RegExp(`^[\\x20-\\x7e\\r\\n\\t]{0,${most}}$`).test(value);
const oneOf = (...words) => (value) => words.includes(value);
const like = (form) => (value) => form.test(value);
const decimal = like(/^-?\d+(\.\d+)?$/), timespan = like(/^\d{2,4}:[0-5]\d:[0-5]\d(\.\d{1,2})?$/);
const score = (value) => value === "" || (decimal(value) && +value >= 0 && +value <= 100);
const RESPONSES = {choice: like(/^[a-z0-9](,[a-z0-9])*$/), numeric: decimal, "fill-in": text(255)};
const READ = 1, WRITE = 2, BOTH = 3;
const MODEL = {
  "core.student_id": [READ], "core.student_name": [READ], "core.credit": [READ], "core.entry": [READ], "core.total_time": [READ],
  "core.lesson_mode": [READ], "launch_data": [READ], "core.lesson_location": [BOTH, text(255)],
  "core.lesson_status": [BOTH, oneOf("passed", "completed", "failed", "incomplete", "browsed")],
  "core.score.raw": [BOTH, score], "core.score.min": [BOTH, score], "core.score.max": [BOTH, score],
  "core.exit": [WRITE, oneOf("time-out", "suspend", "logout", "")], "core.session_time": [WRITE, timespan],
  "suspend_data": [BOTH, text(4096)], "interactions._count": [READ],
};
const INTERACTION = {
  id: like(/^[\w-]{1,255}$/), type: oneOf("true-false", "choice", "fill-in", "matching", "performance", "sequencing", "likert", "numeric"),
  time: like(/^([01]\d|2[0-3]):[0-5]\d:[0-5]\d(\.\d{1,2})?$/), weighting: decimal, latency: timespan, student_response: null,
  result: (value) => oneOf("correct", "wrong", "unanticipated", "neutral")(value) || decimal(value),
};

const system = {record: {}, faults: [], log: [], refuses: "", state: "new"};
let values, interactions, error;

// Begin a visit of a student, with what was committed at the last.
system.begin = (record) => {
  const usual = {"core.student_id": "7", "core.student_name": "", "core.credit": "credit", "core.lesson_mode": "normal", "core.entry": "ab-initio",
    "core.lesson_status": "not attempted", "core.total_time": "0000:00:00.00", "core.lesson_location": "", "suspend_data": "", launch_data: "",
    "core.score.raw": "", "core.score.min": "", "core.score.max": "", interactions: []};
  system.record = {...usual, ...record};
  Object.assign(system, {faults: [], log: [], state: "new"});
};

function answer(code, given = "true") {
  error = code;
  if (code !== "0") system.faults.push([code, ...system.log[system.log.length - 1]]);
  return code === "0" ? given : given === "true" ? "false" : "";
}

function called(name, ...given) {
  system.log.push([name, ...given]);
  if (given.some((one) => typeof one !== "string")) return "201";
  if (name !== "LMSInitialize" && system.state !== "open") return "301";
  return "0";
}

function closing(name, given) {
  const code = called(name, given);
  return code !== "0" ? code : given !== "" ? "201" : "0";
}

function write(name, value) {
  if (!name.startsWith("cmi.")) return "201";
  const key = name.slice(4), [, index, part] = /^interactions\.(\d+)\.(\w+)$/.exec(key) ?? [];
  if (/_(count|children|version)$/.test(key)) return "402";
  if (part) return writeInteraction(+index, part, value);
  if (!MODEL[key]) return key.startsWith("core.") || key.startsWith("interactions") ? "201" : "401";
  const [access, fits] = MODEL[key];
  if (!(access & WRITE)) return "403";
  if (!fits(value) || key === system.refuses) return "405";
  values[key] = value;
  return "0";
}

function writeInteraction(index, part, value) {
  if (!(part in INTERACTION) || index > interactions.length) return "201";
  const one = interactions[index] ?? {};
  if (part !== "id" && !one.id) return "201";
  const fits = part === "student_response" ? RESPONSES[one.type] : INTERACTION[part];
  if (!fits || !fits(value)) return "405";
  interactions[index] = {...one, [part]: value};
  return "0";
}

function read(name) {
  const key = name.slice(4);
  if (!name.startsWith("cmi.")) return ["201", ""];
  if (key === "interactions._count") return ["0", String(interactions.length)];
  if (/^interactions\.\d+\./.test(key)) return ["404", ""];
  if (!MODEL[key]) return [key.endsWith("_count") ? "203" : "201", ""];
  return MODEL[key][0] & READ ? ["0", values[key] ?? ""] : ["404", ""];
}

function total(...spans) {
  const seconds = spans.reduce((sum, span) => sum + span.split(":").reduce((all, part) => 60 * all + Number(part), 0), 0);
  const two = (value) => String(Math.floor(value)).padStart(2, "0");
  return `${String(Math.floor(seconds / 3600)).padStart(4, "0")}:${two(seconds / 60 % 60)}:${two(seconds % 60)}.00`;
}

window.API = {
  LMSInitialize(given) {
    const code = called("LMSInitialize", given);
    if (code !== "0" || given !== "") return answer("201");
    if (system.state !== "new") return answer("101");
    values = {...system.record};
    interactions = structuredClone(system.record.interactions);
    system.state = "open";
    return answer("0");
  },
  LMSGetValue(name) {
    const code = called("LMSGetValue", name), [found, value] = code === "0" ? read(name) : [code, ""];
    return answer(found, value);
  },
  LMSSetValue(name, value) {
    const code = called("LMSSetValue", name, value);
    return answer(code === "0" ? write(name, value) : code);
  },
  LMSCommit(given) {
    const code = closing("LMSCommit", given);
    if (code === "0") system.record = {...values, interactions: structuredClone(interactions)};
    return answer(code === "0" && system.refuses === "commit" ? "101" : code);
  },
  LMSFinish(given) {
    const code = closing("LMSFinish", given);
    if (code !== "0") return answer(code);
    system.state = "ended";
    const {"core.exit": exit, "core.session_time": session, ...record} = values;
    const kept = exit === "suspend" ? {"core.entry": "resume"} : {"core.entry": "", suspend_data: "", "core.lesson_location": ""};
    system.record = {...record, ...kept, interactions, "core.total_time": total(record["core.total_time"], session ?? "00:00:00")};
    return answer("0");
  },
  LMSGetLastError: () => error,
  LMSGetErrorString: (code) => `error ${code}`,
  LMSGetDiagnostic: () => "",
};
window.system = system;
