// A file of one's own code: dropped anywhere on the page, or chosen with its button. It is handed to the viewer's own
// button for files, which nobody sees; what is too large is not even sent.
(() => {
  const mark = () => document.querySelector("[data-lab~=lab-upload] i.lab-upload");
  const field = () => document.querySelector("[data-lab~=lab-upload] + div input[type=file]");
  const files = event => [...event.dataTransfer?.types || []].includes("Files") && field();
  const over = on => document.body.classList.toggle("lab-dropping", on);
  let said = null;

  function say(sentence) {
    said?.remove();
    const own = said = document.body.appendChild(makeElement("div", {className: "lab-notice lab-refused", role: "status"}, sentence));
    setTimeout(() => own.remove(), 10000);
  }

  function fits(file) {
    const {largest, tooLarge, busy} = mark().dataset;
    const refusal = field().parentElement.querySelector("button").disabled ? busy : file.size > largest ? tooLarge : "";
    if (refusal) say(refusal); else said?.remove();
    return !refusal;
  }

  addEventListener("dragover", event => {
    if (!files(event)) return;
    event.preventDefault();
    over(true);
  }, true);
  addEventListener("dragleave", event => event.relatedTarget || over(false), true);
  addEventListener("drop", event => {
    over(false);
    if (!files(event)) return;
    event.preventDefault();
    event.stopPropagation();
    if (event.dataTransfer.files.length !== 1) return say(mark().dataset.one);
    field().files = event.dataTransfer.files;
    field().dispatchEvent(new Event("change", {bubbles: true}));
  }, true);
  addEventListener("change", event => {
    if (event.target !== field()) return;
    if (!event.target.files.length || !fits(event.target.files[0])) event.stopImmediatePropagation();
  }, true);
  document.addEventListener("click", event => {
    if (!event.target.closest("[data-lab~=lab-choose] + div button, [data-own=file]") || !field()) return;
    field().value = "";
    field().click();
  });
})();
