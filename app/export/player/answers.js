// The widgets by which a question is answered: each returns an element and what is answered now.

function answerWidget(question, answer, fixed) {
  const made = {choice: choiceWidget, drag: dragWidget, interval: intervalWidget, text: textWidget, number: numberWidget};
  return made[question.kind](question, answer, fixed);
}

function choiceWidget(question, answer, fixed) {
  const box = element("fieldset", "", {className: "options", disabled: fixed});
  box.append(element("legend", tr("Answer")));
  own(question.options).forEach((option, k) => {
    const line = element("label"), button = element("input", "", {type: "radio", name: "answer", value: k + 1, checked: answer === k + 1});
    line.append(button, ofLesson("span", option));
    box.append(line);
  });
  return [box, () => {
    const chosen = box.querySelector("input:checked");
    return chosen ? +chosen.value : null;
  }];
}

function field(label, widget) {
  const line = element("label", "", {className: "answer"});
  line.append(element("span", label), widget);
  return line;
}

// A number, also with a decimal comma or a true minus, or a size as the page writes it: 2.75 mm/s.
function numberIn(text, unit) {
  const plain = text.trim().replace(",", ".").replace("−", "-");
  const found = /^([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*(.*)$/i.exec(plain);
  if (!found || !found[2]) return found ? Number(found[1]) : null;
  if (!unit || !(Number(found[1]) > 0)) return null;
  const thirds = Object.keys(PREFIXES);
  for (const asked of thirds) {  // that unit, or another of its prefixes: 330 nm where µm are asked for
    if (!unit.startsWith(PREFIXES[asked]) || unit === PREFIXES[asked]) continue;
    const said = thirds.find((third) => found[2] === PREFIXES[third] + unit.slice(PREFIXES[asked].length));
    if (said !== undefined) return Number((found[1] * 1000 ** (said - asked)).toPrecision(12));
  }
  return null;
}

function numberWidget(question, answer, fixed) {
  const text = element("input", "", {type: "text", inputMode: "decimal", maxLength: 40, disabled: fixed, value: answer ?? ""});
  return [field(question.unit ? tr("Answer, {unit}", question) : tr("Answer"), text), () => numberIn(text.value, question.unit)];
}

function intervalWidget(question, answer, fixed) {
  const box = element("div"), texts = [tr("At least"), tr("At most")].map((side, k) => {
    const text = element("input", "", {type: "text", inputMode: "decimal", maxLength: 40, disabled: fixed, value: answer ? answer[k] : ""});
    box.append(field(question.unit ? `${side}, ${question.unit}` : side, text));
    return text;
  });
  return [box, () => texts.map((text) => numberIn(text.value, question.unit))];
}

function textWidget(question, answer, fixed) {
  const text = element("textarea", "", {rows: 4, maxLength: LESSON.longest, disabled: fixed, value: answer ?? ""});
  return [field(tr("Answer"), text), () => text.value];
}

function dragWidget(question, answer, fixed) {
  const {name, low, high, step, powers} = question.drag;
  const start = answer === undefined ? (low + high) / 2 : powers ? Math.log10(answer) : answer;
  const range = element("input", "", {type: "range", min: low, max: high, step, disabled: fixed});
  range.value = start;
  const value = () => powers ? Number((10 ** range.value).toPrecision(3)) : Math.round(range.value);
  const told = element("output", "", {className: "dragged"}), line = field(name, range);
  const tell = () => {
    told.textContent = `${number(value())} ${question.unit}`;
    range.setAttribute("aria-valuetext", told.textContent);
  };
  range.addEventListener("input", tell);
  tell();
  line.append(told);
  return [line, value];
}
