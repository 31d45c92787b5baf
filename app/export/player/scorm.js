// SCORM 1.2: the object with which a course's system speaks, and numbers and texts in the forms that it takes.

const LEVELS = 7;  // windows above this one that are looked through
const LONGEST_RESPONSE = 255;

// The system's object in a window or above it. A frame of another origin shows nothing, and what is above it may.
function apiAbove(from) {
  for (let at = from, level = 0; at && level <= LEVELS; at = at.parent, level++) {
    try {
      if (at.API?.LMSInitialize) return at.API;
    } catch {
      // of another origin
    }
    if (at.parent === at) return null;
  }
  return null;
}

function apiOfCourse() {
  return apiAbove(window) ?? apiAbove(window.opener) ?? apiAbove(window.top.opener);
}

// What the system answers to one of its functions; "" where it fails.
function callOf(api) {
  return (name, ...given) => {
    try {
      return String(api[name](...given));
    } catch {
      return "";
    }
  };
}

// HHHH:MM:SS.SS
function timespan(seconds) {
  const hundredths = Math.min(Math.round(100 * seconds), 359999999), two = (value) => String(value).padStart(2, "0");
  const [hours, minutes, rest] = [Math.floor(hundredths / 360000), Math.floor(hundredths / 6000) % 60, hundredths % 6000];
  return `${String(hours).padStart(4, "0")}:${two(minutes)}:${two(Math.floor(rest / 100))}.${two(rest % 100)}`;
}

// A number without a power of ten, to nine digits.
function decimal(value) {
  if (Math.abs(value) >= 1e21) return String(BigInt(value));
  const power = value ? Math.floor(Math.log10(Math.abs(value))) : 0, text = value.toFixed(Math.min(Math.max(8 - power, 0), 100));
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

// A text as a system may take it: in its own letters, or where that knows none but the oldest, with ? for all others.
function responses(text) {
  const line = text.replace(/\s+/g, " ").trim();
  return [line, line.replace(/[^\x20-\x7e]/gu, "?")].map((one) => one.slice(0, LONGEST_RESPONSE));
}

// Type and response, in the forms that may be taken, of an answer to a question.
function interaction(question, answer) {
  if (question.kind === "choice") return ["choice", [String.fromCharCode(96 + answer)]];
  if (question.kind === "text") return ["fill-in", responses(answer)];
  if (question.kind === "interval") return ["fill-in", responses(answer.map(decimal).join(" to "))];
  return ["numeric", [decimal(answer)]];
}
