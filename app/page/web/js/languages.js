// A link to the page in another language (panels/page_header.py) goes there with all that is seen.
document.addEventListener("click", event => {
  const link = event.target.closest?.("a.lab-language"), asked = new URLSearchParams(location.search);
  if (!link) return;
  asked.set("lang", link.lang);
  const seen = document.documentElement.dataset.link;  // the address may not say it yet
  link.href = `?${asked}${seen ? "#" + seen : ""}`;
}, true);
