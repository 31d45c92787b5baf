// The opening story (page/opening_tour.py): asked for once where somebody comes without a link for the first time, or by ?story;
// left by a button or any key. It is body classes and a row of buttons; the words are the headline's.
(() => {
  const KEY = "mpm-lab-story", row = document.getElementById("lab-sparks"), asks = new URLSearchParams(location.search);
  const linked = document.documentElement.classList.contains("lab-linked") && !asks.has("story");
  const seen = () => { try { return localStorage.getItem(KEY) !== null; } catch { return true; } };  // may be forbidden
  const tell = story => dispatchEvent(new CustomEvent("lab-tell", {detail: {story}}));
  let wanted = asks.has("story") || !(linked || asks.has("present") || seen());
  let beat = "0";

  addEventListener("lab-asked", () => {
    if (!wanted) return;
    wanted = false;
    tell("play");
  });
  document.addEventListener("click", event => {
    if (event.target.closest("[data-lab~=lab-replay] + div button")) dispatchEvent(new CustomEvent("lab-tab", {detail: "Explore"}));
  });
  addEventListener("keydown", event => {
    if (beat !== "0" && !["Tab", "Shift", "Control", "Alt", "Meta", "CapsLock"].includes(event.key) && !event.repeat) tell("skip");
  });
  new MutationObserver(() => {
    const now = document.querySelector(".lab-story")?.dataset.beat || "0";
    if (now === beat) return;
    beat = now;
    document.body.classList.toggle("lab-story-told", beat !== "0");
    if (beat === "0") return document.getElementById("lab-beats")?.remove();
    try { localStorage.setItem(KEY, "seen"); } catch { /* it is told again */ }
    let bar = document.getElementById("lab-beats");
    if (!bar) {
      bar = document.createElement("div");
      bar.id = "lab-beats";
      const steps = bar.appendChild(document.createElement("span")), skip = bar.appendChild(document.createElement("button"));
      steps.className = "lab-steps";
      skip.textContent = tr("Skip the introduction");
      skip.addEventListener("click", () => tell("skip"));
      row.after(bar);
    }
    bar.firstChild.textContent = tr("{beat} of 4", {beat});
    bar.style.setProperty("--beat", beat);
  }).observe(document.getElementById("root"), {childList: true, subtree: true});
})();
