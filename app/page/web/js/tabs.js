// Which tab is open. The viewer makes its tabs anew when a window turns narrow or wide, and opens the first one then: the
// visitor's own is opened again. And whoever says "lab-tab" has one opened, which may come only later. In style and scripts
// they are called as in English, whatever stands on them.
(() => {
  const NAMES = new Map([[tr("Explore"), "Explore"], [tr("Lessons"), "Lessons"], [tr("Cost"), "Cost"], [tr("About"), "About"]]);
  let first = null, open = null, wanted = null, pressed = null;
  const name = tab => NAMES.get(tab.textContent.trim());

  function look() {
    const tabs = [...document.querySelectorAll("[role=tablist]")].map(list => [...list.querySelectorAll("[role=tab]")])
      .find(list => list.some(tab => name(tab) === "Explore"));
    if (!tabs) return;
    const anew = tabs[0] !== first, selected = tabs.find(tab => tab.getAttribute("aria-selected") === "true");
    first = tabs[0];
    if (anew && open && tabs.some(tab => name(tab) === open)) wanted ||= open;
    if (selected && (!wanted || name(selected) === wanted)) {
      open = name(selected);
      if (document.body.dataset.tab !== open) document.body.dataset.tab = open;
      wanted = null;
    }
    if (open === "Cost" && !document.body.classList.contains("lab-cost-open"))
      tellPage({cost: true});  // a search will be asked for
    document.body.classList.toggle("lab-cost-open", open === "Cost");  // its chart takes the stage's place
    const tab = wanted && !pressed && tabs.find(tab => name(tab) === wanted);
    if (tab) {  // in wide windows tabs hear keys, and pointers, which may drag; in narrow ones clicks
      pressed = setTimeout(() => { pressed = null; look(); }, 500);
      tab.dispatchEvent(new KeyboardEvent("keydown", {key: "Enter", bubbles: true}));
      tab.click();
    }
  }

  addEventListener("lab-tab", event => { wanted = event.detail; look(); });
  watchPage(look, ["aria-selected"]);
})();
