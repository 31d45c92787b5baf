// Figures of a lesson are small beside the stage: a click, or Enter, shows one as large as the window, and another puts it
// back; so does Escape.
(() => {
  const figure = event => event.target.closest?.(".lab-lesson img");
  const back = () => document.querySelectorAll("img.lab-large").forEach(image => image.classList.remove("lab-large"));
  document.addEventListener("click", event => figure(event)?.classList.toggle("lab-large"));
  addEventListener("keydown", event => {
    if (event.key === "Escape") back();
    if (event.key === "Enter" && figure(event)) figure(event).classList.toggle("lab-large");
  });
})();
