// What the browser keeps for its visitor: the state in the address, so that a reload or a copied link brings it back, and
// the answers to lessons. It tells the page through a text that nobody sees.
(() => {
  const STORE = "mpm-lab/", LONGEST = 20000;
  let field = null, lesson = null, opened = "", link = "", shown = "", count = 0;
  const read = () => {  // the class code is not for keeping; and the viewer cannot connect from an address with a fragment
    const said = location.hash.slice(1).replace(/^code=[^&]*&?/, "");
    try { link = decodeURIComponent(said); } catch { link = said; }
  };

  // The viewer passes on what stands in the text now and then: what is said sooner waits, together with what follows.
  const waiting = [];
  let busy = null;
  function tell(said) {
    const last = waiting[waiting.length - 1];
    if (last && !("act" in last && "act" in said)) Object.assign(last, said); else waiting.push({...said});
    busy ??= setTimeout(send);
  }
  function send() {
    const text = waiting.length && field ? JSON.stringify({count: ++count, ...waiting.shift()}) : "";
    busy = text ? setTimeout(send, 100) : null;
    if (!text || text.length > LONGEST) return;
    typeInto(field, text);
  }

  // The address names a language that is not the lab's own, or that has been asked for: it goes with every link.
  const spoken = document.documentElement.lang, asked = new URLSearchParams(location.search).getAll("lang").pop();
  const named = asked?.toLowerCase() === spoken, search = named || spoken === "en" ? location.search
    : `${location.search || "?"}${location.search ? "&" : ""}lang=${spoken}`;
  const here = location.origin + location.pathname + (named || spoken !== "en" ? `?lang=${spoken}` : "");
  // What is to be seen, for a link elsewhere: what was asked for, until the page has another one than at first.
  const root = document.documentElement;
  let asking = "", first = null;
  const writeAddress = () => {
    history.replaceState(null, "", location.pathname + search + (link && "#" + link));
    firstMessage = {link, here};  // should the connection be lost
  };
  const tellLink = () => {
    [asking, first, root.dataset.link] = [link, null, link || root.dataset.link || ""];
    writeAddress();
    tell({link, here});
  };

  read();
  root.dataset.link = link;
  root.classList.toggle("lab-linked", link !== "");
  history.replaceState(null, "", location.pathname + search);
  firstMessage = {link, here};

  function look() {
    const found = document.querySelector("[data-lab~=lab-store] + div input");
    if (!found) { field = lesson = null; return; }
    if (found !== field) {
      field = found;
      lesson = null;  // what the one before was told may not have been passed on
      tellLink();
      dispatchEvent(new Event("lab-asked"));
    }
    const kept = document.querySelector(".lab-kept")?.dataset;
    if (!kept) return;
    if ((kept.lesson || "") !== lesson) {
      lesson = kept.lesson || "";
      if (lesson && lesson !== opened) openTab("Lessons");
      opened = lesson;
      if (lesson) tell({lesson, answers: fromStorage(store => store.getItem(STORE + lesson), "") || ""});
    }
    if (lesson && kept.answers) fromStorage(store => store.setItem(STORE + lesson, kept.answers));
    if (!kept.link) return;
    first ??= kept.link;
    if (asking && kept.link === first) return;  // it has what it shows everybody at first, and not yet what was asked for
    asking = "";
    if (root.dataset.link !== kept.link) root.dataset.link = kept.link;  // to say it again is a change, too
    if (kept.link !== shown) {
      link = shown = kept.link;
      writeAddress();
    }
  }

  addEventListener("lab-tell", event => field ? tell(event.detail) : Object.assign(firstMessage, event.detail));  // what other scripts say
  addEventListener("hashchange", () => {  // somebody has typed or followed another link on the same page
    read();
    if (field && link) tellLink();
  });
  document.addEventListener("click", event => {  // only in a click may a page copy
    if (!event.target.closest("[data-lab~=lab-copy] + div button")) return;
    const copied = () => document.body.classList.add("lab-copied") || setTimeout(() =>
      document.body.classList.remove("lab-copied"), 2000);
    const old = () => {
      const text = document.body.appendChild(document.createElement("textarea"));
      text.value = location.href;
      text.select();
      if (document.execCommand("copy")) copied();
      text.remove();
    };
    if (navigator.clipboard) navigator.clipboard.writeText(location.href).then(copied, old); else old();
  });
  watchPage(look, ["data-link", "data-lesson", "data-answers"]);
})();
