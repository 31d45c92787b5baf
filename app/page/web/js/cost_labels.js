// Names in the chart of the Cost tab keep apart, whatever the window: methods move down until they are free, and
// numbers of cells that would touch anything are not shown.
(() => {
  const FEW = 40;  // runs between which a name finds a place
  const section = document.getElementById("lab-cost"), dots = section.querySelector(".lab-dots");
  const all = name => [...dots.querySelectorAll(name)], box = element => element.getBoundingClientRect();
  const apart = (one, other) => one.left >= other.right || other.left >= one.right || one.top >= other.bottom
    || other.top >= one.bottom;
  const show = (element, shown) => { element.style.visibility = shown ? "" : "hidden"; };

  function settle() {
    const edge = box(section).right - 4, taken = [], free = one => taken.every(other => apart(one, other));
    const names = all(".lab-name, .lab-on-stage"), cells = all(".lab-cells");
    const marks = all(".lab-dot").map(box).map(({left, top, right, bottom}) => (  // less what is empty around them
      {left: left + 5, right: right - 5, top: top + 5, bottom: bottom - 5}));
    if (marks.length < FEW) taken.push(...marks);
    const wish = box(section.querySelector(".lab-wish span"));
    if (wish.width) taken.push(wish);
    for (const name of names) {
      name.style.translate = "";
      name.classList.remove("lab-left");
    }
    const wide = names.filter(name => name.matches(".lab-name:not(.lab-at-edge)") && box(name).right > edge);
    for (const name of wide) name.classList.add("lab-left");
    for (const [name, at] of names.map(name => [name, box(name)]).sort((one, other) => one[1].top - other[1].top)) {
      const moved = down => ({left: at.left, right: at.right, top: at.top + down, bottom: at.bottom + down});
      let down = 0;
      while (!free(moved(down)) && down < 200) down += 2;
      if (down) name.style.translate = `0 ${down}px`;
      taken.push(moved(down));
    }
    if (marks.length >= FEW) taken.push(...marks);
    const shown = cells.map(cell => [cell, box(cell)]).map(([cell, at]) => [cell, free(at) && taken.push(at)]);
    for (const [cell, isFree] of shown) show(cell, isFree);
  }

  addEventListener("lab-cost-drawn", settle);
  let due = 0;
  addEventListener("lab-cost-wished", () => {
    cancelAnimationFrame(due);
    due = requestAnimationFrame(settle);
  });
  new ResizeObserver(settle).observe(dots);
})();
