// A link to the page in another language (panels/languages.py) goes there with all that is seen, which is in the address.
document.addEventListener("click", event => {
  const link = event.target.closest?.("a.lab-language"), asked = new URLSearchParams(location.search);
  if (!link) return;
  asked.set("lang", link.lang);
  link.href = `?${asked}${location.hash}`;
}, true);
