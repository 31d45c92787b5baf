// Names for those who hear the page instead of seeing it: the viewer's widgets, panels and plots come without.
(() => {
  const set = (element, name, value) => { if (element && value) changeAttribute(element, name, value); };
  const row = label => label.closest(".mantine-Flex-root")?.querySelectorAll(
    "[role=slider], input:not([type=hidden]), textarea:not([aria-hidden])");
  const all = (selector, act) => document.querySelectorAll(selector).forEach(act);

  function name() {
    all("label[for]", label => row(label)?.forEach(input => set(input, "aria-label", label.innerText)));
    all("[data-lab~=lab-typed]", mark => {  // the text beside a slider: its label is there, but cannot be seen
      const next = mark.nextElementSibling, label = next?.querySelector("label");
      set(next?.querySelector("input"), "aria-label", label?.textContent);
    });
    all("[role=progressbar]", bar => set(bar, "aria-label", tr("progress")));
    all("[role=slider]", slider => {  // a logarithm is no number that anybody wants to hear; a row's own script reads more
      const text = slider.closest("[data-lab=\"lab-words lab-logarithmic\"] + div")?.nextElementSibling?.nextElementSibling;
      set(slider, "aria-valuetext", text?.querySelector("input")?.value);
    });
    all(".uplot-container", plot => {
      const heading = plot.closest("div:has(> .uplot-container)")?.previousElementSibling?.textContent;
      set(plot, "role", "img");
      set(plot, "aria-label", tr("plot over time: {heading}", {heading: heading || ""}));
    });
    all("[data-scrollarea-viewport], pre", area => set(area, "tabindex", "0"));
    set(document.querySelector("[data-dock-root] > div:first-child"), "role", "main");
    all("[data-dock-region=left]", area => { set(area, "role", "region"); set(area, "aria-label", tr("measurements")); });
    all("[data-dock-region=right], .mantine-Paper-root[style*='position: fixed']", area => {
      set(area, "role", "region");
      set(area, "aria-label", tr("controls"));
    });
  }

  watchPage(name, undefined, 300);  // numbers change all the time, names seldom
})();
