// The opening story (page/features/opening_tour.py): asked for once where somebody comes without a link for the first time, or by
// ?story; left by a button or any key. It is body classes and a row of bars and buttons; the words are the headline's.
(() => {
  const KEY = "mpm-lab-story", verdict = document.getElementById("lab-verdict"), asks = new URLSearchParams(location.search);
  const panel = () => document.querySelector("[data-dock-region=right]");
  const linked = document.documentElement.classList.contains("lab-linked") && !asks.has("story");
  const seen = () => fromStorage(store => store.getItem(KEY) !== null, true);
  const tell = story => tellPage({story});
  const stands = matchMedia("(prefers-reduced-motion: reduce)");
  let wanted = asks.has("story") || !(linked || asks.has("present") || seen());
  let beat = wanted ? null : 0;
  if (wanted) document.body.classList.add("lab-story-told");  // the first picture has its place from the start

  function start() {
    document.getElementById("lab-first-words")?.remove();
    tell(stands.matches ? "stills" : "play");
  }
  if (wanted) start();
  addEventListener("lab-asked", () => {
    if (!wanted) return;
    wanted = false;
    start();  // it begins when it can be seen
  });
  document.addEventListener("click", event => {
    if (!event.target.closest("[data-lab~=lab-replay] + div button")) return;
    openTab("Explore");
    start();
  });
  addEventListener("keydown", event => {
    if (!beat || event.repeat || ["Tab", "Shift", "Control", "Alt", "Meta", "CapsLock"].includes(event.key)) return;
    if (event.key === "Escape" || !event.target.closest("#lab-beats")) skip();
  });

  function button(text, act) {
    const made = makeElement("button", {}, text);
    made.addEventListener("click", act);
    return made;
  }
  function skip() {
    tell("skip");
    const said = `${tr("A bar, cut into particles.")} ${tr("A computer moves them through a fixed grid, step by step: the Material Point Method, MPM.")}`;
    const note = makeElement("p", {id: "lab-first-words"}, makeElement("span", {}, said), button(tr("Close"), () => note.remove()));
    verdict.append(note);
  }
  // What is asked for at last pulses until somebody has it in hand.
  function invite() {
    const name = [...document.querySelectorAll("label")].find(label => label.textContent.trim() === tr("Amplitude A"));
    const row = name?.closest(".mantine-Flex-root")?.parentElement;
    if (!row) return;
    row.classList.add("lab-invites");
    for (const act of ["pointerdown", "focusin", "keydown"]) row.addEventListener(act, () => row.classList.remove("lab-invites"), {once: true});
  }
  function bars(seconds) {
    const made = makeElement("div", {id: "lab-beats"}, ...[1, 2, 3, 4].map(() => makeElement("i")), button(tr("Skip"), skip));
    if (!seconds) made.append(button(tr("Next"), () => tell("next")));
    verdict.after(made);
    return made;
  }

  watchPage(() => {
    const said = document.querySelector(".lab-story")?.dataset, now = Number(said?.beat);
    if (!said || now === beat) return;
    beat = now;
    document.body.classList.toggle("lab-story-told", beat > 0);
    document.body.dataset.beat = beat;
    panel()?.toggleAttribute("inert", beat > 0 && beat < 4);
    if (!beat) {
      document.getElementById("lab-beats")?.remove();
      return invite();
    }
    fromStorage(store => store.setItem(KEY, "seen"));
    const made = document.getElementById("lab-beats") || bars(Number(said.seconds));
    made.style.setProperty("--seconds", `${said.seconds}s`);
    made.querySelectorAll("i").forEach((bar, k) => { bar.className = ["lab-told", "lab-telling", ""][k + 1 < beat ? 0 : k + 1 === beat ? 1 : 2]; });
    made.setAttribute("aria-label", tr("{beat} of 4", {beat}));
  });
})();
