// What is said (page/headline_panel.py): the headline in spans that mean something to the eye, and the facts below it. All of it
// is text. It changes for as long as a run goes on: read aloud is only what is of another moment, or answers a click.
(() => {
  const summary = document.getElementById("lab-summary"), aloud = document.getElementById("lab-aloud");
  const verdict = summary.parentElement, sparks = document.getElementById("lab-sparks");
  let said = null, count = null, long = false;  // a headline that was too long stays small for its moment
  const together = text => text.replace(/(\d) (?=%|[pnµmkMG]?(?:m|s|Pa)\b)| (?=[=] )|(?<= =) /g, "$1\u00a0")
    .replace(/–(?=\d)/g, "–\u2060");  // no line ends within "25 mm", "t = 0.2 s" or "0.25–0.30"
  const line = (name, spans) => makeElement("span", {className: name}, ...spans.map(([kind, text]) =>
    makeElement("span", {className: kind && `lab-${kind}`}, together(text))));
  const isBelow = () => sparks.parentElement === verdict && sparks.offsetHeight > 0;
  const overflows = () => summary.getBoundingClientRect().bottom >
    (isBelow() ? sparks.getBoundingClientRect().top : verdict.getBoundingClientRect().bottom);
  // Why a run is lost ends with its remedy: the stage makes room for all of it, above the ways on.
  function makeRoom() {
    document.body.style.removeProperty("--verdict");
    if (!summary.querySelector(".lab-bad")) return;
    const below = isBelow() ? sparks.offsetHeight + 11 : 0;
    const needs = summary.offsetTop + summary.offsetHeight + 6 + below;
    if (needs > verdict.offsetHeight) document.body.style.setProperty("--verdict", `${needs}px`);
  }

  function look() {
    const says = document.querySelector(".lab-says"), sentence = says ? says.dataset.sentence : "";
    if (sentence === said) return;
    said = sentence;
    if (!says) {
      summary.replaceChildren();
      return makeRoom();
    }
    const [headline, facts] = JSON.parse(says.dataset.spans);
    const first = line("lab-headline", headline);
    const further = line("lab-facts", facts.map((fact, k) => ["", (k ? " " : "") + fact]));
    further.title = facts.join(" ");  // there may be room for the first ones only
    summary.replaceChildren(first, " ", further);
    const bad = headline.some(([kind]) => kind === "bad");  // with reasons below
    long = bad || (long && says.dataset.aloud === count) || overflows();
    first.classList.toggle("lab-long", long);
    makeRoom();
    if (says.dataset.aloud !== count && count !== null) aloud.textContent = sentence;
    count = says.dataset.aloud;
  }
  new ResizeObserver(makeRoom).observe(sparks);
  addEventListener("resize", () => {
    [said, long] = [null, false];
    look();
  });
  watchPage(look);
})();
