// On a phone the panel is a sheet with three stops: it is drawn by its grip, or moved by keys and clicks. The questions above
// the stage stand at its top, and what the transport has no room for behind a button.
(() => {
  const STOPS = [16, 40, 85], body = document.body, phone = matchMedia("(max-width: 640px)");
  const grip = document.getElementById("lab-grip"), more = document.getElementById("lab-more");
  const sparks = document.getElementById("lab-sparks"), verdict = sparks.parentElement;
  const full = () => Math.max(innerHeight, body.offsetHeight);  // a low window's page is higher, and scrolls
  let stop = 1, from = null;

  function set(to) {
    stop = Math.min(STOPS.length - 1, Math.max(0, to));
    body.style.removeProperty("--sheet");
    for (const [k, name] of ["low", "middle", "high"].entries()) body.classList.toggle(`lab-sheet-${name}`, k === stop);
    grip.setAttribute("aria-valuenow", STOPS[stop]);
    grip.setAttribute("aria-valuetext", tr("{percent} % of the screen", {percent: STOPS[stop]}));
  }

  grip.addEventListener("pointerdown", event => {
    from = event.clientY;
    grip.setPointerCapture(event.pointerId);
  });
  grip.addEventListener("pointermove", event => {
    if (from !== null) body.style.setProperty("--sheet", `${Math.max(80, full() - event.clientY - scrollY + 12)}px`);
  });
  grip.addEventListener("pointerup", event => {
    if (from === null) return;
    const moved = event.clientY - from, high = 100 * (full() - event.clientY - scrollY + 12) / full();
    from = null;
    if (Math.abs(moved) < 6) return set((stop + 1) % STOPS.length);
    const nearest = STOPS.indexOf([...STOPS].sort((a, b) => Math.abs(a - high) - Math.abs(b - high))[0]);
    set(nearest !== stop ? nearest : Math.abs(moved) > 40 ? stop - Math.sign(moved) : stop);
  });
  grip.addEventListener("pointercancel", () => { from = null; set(stop); });
  grip.addEventListener("keydown", event => {
    const to = {ArrowUp: stop + 1, ArrowDown: stop - 1, Home: 0, End: 2, Enter: (stop + 1) % 3, " ": (stop + 1) % 3}[event.key];
    if (to === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    set(to);
  });

  const open = on => { body.classList.toggle("lab-deck-open", on); more.setAttribute("aria-expanded", on); };
  more.addEventListener("click", () => open(!body.classList.contains("lab-deck-open")));
  document.addEventListener("pointerdown", event => {
    if (body.classList.contains("lab-deck-open") && !event.target.closest("#lab-deck, [data-lab*=lab-at-] + div, [role=listbox]"))
      open(false);
  });

  function look() {
    body.classList.toggle("lab-phone", phone.matches);
    const speed = document.querySelector("[data-lab~=lab-at-speed] + div input")?.value;
    const said = !speed ? "…" : /\p{L}/u.test(speed) ? speed : `${speed} ×`;
    changeText(more, said);
    const place = phone.matches ? document.querySelector(".lab-sparks-here") : verdict;
    if (place && sparks.parentElement !== place) place.append(sparks);
    else if (!place && sparks.parentElement !== verdict) verdict.append(sparks);
  }
  phone.addEventListener("change", look);
  watchPage(look);
  set(1);
  look();
})();
