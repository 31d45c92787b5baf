// Tells the server whether anybody looks: a run that nobody sees need not be computed, nor its pictures be kept.
(() => {
  const AGAIN = 15000;  // milliseconds after which a page that was refused tries again
  let said = "", again = null;
  const look = () => {
    const visitor = document.querySelector(".lab-visitor")?.dataset.visitor, state = document.hidden ? "away" : "here";
    if (visitor && said !== visitor + state && (said || document.hidden)) {
      fetch(`${state}/${visitor}`, {cache: "no-store", keepalive: true}).catch(() => { said = ""; });
    }
    if (visitor) said = visitor + state;
    if (document.querySelector(".lab-again")) again ??= setTimeout(() => location.reload(), AGAIN);
  };
  document.addEventListener("visibilitychange", look);
  new MutationObserver(look).observe(document.getElementById("root"), {childList: true, subtree: true});
})();
