// Tells the server whether anybody looks: a run that nobody sees need not be computed, nor its pictures be kept.
(() => {
  const SOON = 2000, AGAIN = 15000;  // milliseconds: until it is told again, and until a refused page tries again
  let visitor = "", told = "here", again = null;
  const look = () => {
    const now = document.querySelector(".lab-visitor")?.dataset.visitor || visitor;
    const state = document.hidden ? "away" : "here";
    if (now !== visitor) [visitor, told] = [now, "here"];  // as the server takes for granted
    if (visitor && state !== told) {
      told = state;
      const later = () => { told = ""; setTimeout(look, SOON); };
      fetch(`${state}/${visitor}`, {cache: "no-store", keepalive: true}).then(said => said.ok || later(), later);
    }
    if (document.querySelector(".lab-again")) again ??= setTimeout(() => location.reload(), AGAIN);
  };
  document.addEventListener("visibilitychange", look);
  watchPage(look);
})();
