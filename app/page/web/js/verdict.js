// What is seen, in one sentence. The viewer puts an element's html in anew whenever it changes; a screen reader follows only
// one that stays.
(() => {
  const summary = document.getElementById("lab-summary");
  new MutationObserver(() => {
    const sentence = document.querySelector(".lab-says")?.dataset.sentence || "";
    if (summary.textContent !== sentence) summary.textContent = sentence;
  }).observe(document.getElementById("root"), {childList: true, subtree: true});
})();
