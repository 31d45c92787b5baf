// What many scripts of the page do.
const tellPage = detail => dispatchEvent(new CustomEvent("lab-tell", {detail}));  // to Python, by browser_store.js
const openTab = name => dispatchEvent(new CustomEvent("lab-tab", {detail: name}));
const fromStorage = (act, fallback) => { try { return act(localStorage); } catch { return fallback; } };  // may be forbidden

// Calls act when the page's elements, or those of its attributes that are named, have changed; at once, or after a pause of
// so many milliseconds in which more may change.
function watchPage(act, attributes, pause) {
  let due = null;
  const later = () => { due ??= setTimeout(() => { due = null; act(); }, pause); };
  new MutationObserver(() => pause ? later() : act())
    .observe(document.getElementById("root"), {childList: true, subtree: true, attributeFilter: attributes});
}

function makeElement(tag, properties = {}, ...inside) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...inside);
  return made;
}

function changeAttribute(element, name, value) {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

function changeText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

function typeBehind(mark, text) {  // into the text field that stands behind a mark
  const input = document.querySelector(`[data-lab~=${mark}] + div input`);
  if (input && input.value !== text) typeInto(input, text);
}

function typeInto(input, text) {  // as a visitor would: the viewer's own setter does not hear of it
  Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set.call(input, text);
  input.dispatchEvent(new Event("input", {bubbles: true}));
}
