// Undo: its button is in the head while there is something to undo, and says what. Ctrl Z does the same, but where somebody types.
(() => {
  const button = document.getElementById("lab-undo"), undo = () => window.lab.tell("undo");
  const KEYS = tr("Ctrl Z"), typing = element => element?.isContentEditable || element?.matches("textarea, input:not([type=checkbox], [type=radio])");

  button.addEventListener("click", undo);
  addEventListener("keydown", event => {
    if (!(event.ctrlKey || event.metaKey) || event.shiftKey || event.altKey || event.key.toLowerCase() !== "z" || button.hidden
        || typing(document.activeElement)) return;
    event.preventDefault();
    undo();
  });
  watchPage(() => {
    const title = document.querySelector("i.lab-undo")?.dataset.title || "";
    if (button.title === title && button.hidden === !title) return;
    button.title = title && `${title} (${KEYS})`;
    button.hidden = !title;
  }, ["data-title"]);
})();
