// What the file holds, and what is shown first.

if (typeof DecompressionStream === "undefined") {
  document.getElementById("empty").textContent = tr("This browser is too old for the recordings; any of 2023 or later plays them.");
} else if (DATA.lesson) {
  openLesson();
} else {
  putOnStage(0, !window.matchMedia("(prefers-reduced-motion: reduce)").matches);
}
document.fonts.ready.then(changed);  // a canvas draws with what type there is
