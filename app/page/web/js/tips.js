// Where hints appear: beside the side panel, never on it, and of the deck above it; for the name of a control as for itself;
// and no longer once it has been used. That they wait a little is style.
(() => {
  const rows = ".mantine-Flex-root:has(> div label), button, [role=tab]";
  let over = null;

  const tell = (row, kind) => row?.matches(".mantine-Flex-root") && [row.lastElementChild, row.lastElementChild.firstElementChild]
    .forEach(part => part?.dispatchEvent(new MouseEvent(kind)));

  function place(row) {
    const box = row.getBoundingClientRect(), panel = row.closest("[data-dock-region=right]")?.getBoundingClientRect();
    const beside = panel && box.left >= panel.left && panel.left > 320, style = document.body.style;
    style.setProperty("--tip-right", beside ? `${innerWidth - panel.left + 8}px` : "auto");
    style.setProperty("--tip-left", beside ? "auto" : `${Math.max(8, Math.min(box.left, innerWidth - 276))}px`);
    style.setProperty("--tip-top", beside ? `${box.top}px` : "auto");
    style.setProperty("--tip-bottom", beside ? "auto" : `${innerHeight - box.top + 6}px`);
  }

  document.addEventListener("pointerover", event => {
    const row = event.target.closest?.(rows) || null;
    if (row === over) return;
    tell(over, "mouseleave");
    over = row;
    document.body.classList.remove("lab-used");
    if (row) place(row);
    if (event.target.closest?.("label")) tell(row, "mouseenter");
  });
  for (const used of ["pointerdown", "keydown"])
    document.addEventListener(used, () => document.body.classList.add("lab-used"), true);
})();
