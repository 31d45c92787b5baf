// Bets beside the truth: their scores and their picture, as app/lessons/interval_bets.py and bet_lines.py have them.

const BETS = LESSON?.bets;

function betOf(ends, truth, level) {
  const [low, high, true_] = [ends[0], ends[1], truth].map(Math.log10);
  return {ends, truth, level, holds: ends[0] <= truth && truth <= ends[1],
    score: high - low + 2 / (1 - level) * Math.max(low - true_, true_ - high, 0)};
}

// Who bets on what was asked before a step, and was answered and came out.
function bettorsOf(step) {
  const asked = LESSON.steps.slice(0, LESSON.steps.indexOf(step)).filter((other) => other.question?.kind === "interval"
    && progress.answers[other.key] && own(other.question.rules));
  const yours = Object.fromEntries(asked.map(({key}) => [key, progress.answers[key].first])), judges = own(step.judged);
  return asked.length === 0 ? [] : step.bets.flatMap((name) => {
    const bets = asked.map(({key, question}) => {
      const pair = (judges[name] ?? yours)[key];
      return pair ? betOf(pair, own(question.rules).value, question.level) : null;
    });
    return name === BETS.by_round ? byRound(name, asked, bets) : [{name, bets}];
  });
}

// A student's bets apart by rounds, each of which ends where something is explained.
function byRound(name, asked, bets) {
  const explained = asked.map((step) => LESSON.steps.slice(0, LESSON.steps.indexOf(step)).filter(({kind}) => kind === "explain").length);
  return [...new Set(explained)].map((one, k) => ({name, round: k + 1, bets: bets.filter((_, at) => explained[at] === one)}));
}

function betsDrawn(bettors) {
  const made = ({bets}) => bets.filter((bet) => bet), every = bettors.flatMap(made);
  const mean = (values) => values.reduce((sum, value) => sum + value, 0) / Math.max(1, values.length);
  const decades = (end, bet) => Math.log10(end) - Math.log10(bet.truth);
  const farthest = Math.max(0, ...every.flatMap((bet) => bet.ends.map((end) => Math.abs(decades(end, bet)))));
  const reach = Math.min(Math.max(Math.ceil(farthest), 1), BETS.most);
  const place = (end, bet) => Math.min(Math.max(50 + 50 * decades(end, bet) / reach, 0), 100);
  const factor = (10 ** reach).toString().replace(/\B(?=(\d{3})+$)/g, ",");
  const told = (bettor) => {
    const own = made(bettor), left = bettor.bets.length - own.length;
    return !own.length ? BETS.none : fill(left ? BETS.some : BETS.told, {held: own.filter((bet) => bet.holds).length,
      made: own.length, left, score: fixed(mean(own.map((bet) => bet.score)), 2)});
  };
  return {reach, said: fill(BETS.said, {share: fixed(100 * mean(every.map((bet) => bet.level)), 0)}),
    ticks: [[0, fill(BETS.less, {factor})], [50, BETS.truth], [100, fill(BETS.more, {factor})]],
    bettors: bettors.map((bettor) => ({name: bettor.round ? fill(BETS.round, {number: bettor.round})
      : bettor.name === BETS.yours ? BETS.your_bets : bettor.name, told: told(bettor), own: [BETS.yours, BETS.by_round].includes(bettor.name),
      lines: bettor.bets.map((bet) => bet && [place(bet.ends[0], bet), place(bet.ends[1], bet), bet.holds])}))};
}

function betsFigure(bettors) {
  if (!bettors.length) return "";
  const drawn = betsDrawn(bettors), box = element("figure", "", {className: "bets"});
  const axis = element("div", "", {className: "axis"});
  axis.setAttribute("aria-hidden", "true");
  axis.append(...drawn.ticks.map(([, text]) => element("span", text)));
  box.append(element("figcaption", drawn.said), ...drawn.bettors.map(bettorRow), axis);
  return box;
}

function bettorRow({name, told, own, lines}) {
  const high = own ? 12 : 7, row = element("div"), svg = svgElement("svg", {role: "img", "aria-label": `${name}: ${told}`, height: high * lines.length});
  svg.append(svgElement("line", {class: "truth", x1: "50%", x2: "50%", y1: 0, y2: "100%"}));
  lines.forEach((line, k) => line && svg.append(svgElement("line", {class: line[2] ? "held" : "missed",
    x1: `${line[0].toFixed(2)}%`, x2: `${line[1].toFixed(2)}%`, y1: (k + 0.5) * high, y2: (k + 0.5) * high})));
  row.append(element("b", name), " ", element("span", told), svg);
  return row;
}

function svgElement(tag, attributes) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}
