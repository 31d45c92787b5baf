// The viewer's warning of slow graphics, which would cover the colour bar, does not hold for so light a picture; and how
// far a file has come is said where all else is.
new MutationObserver(() => document.querySelectorAll(".mantine-Notification-root").forEach(said => {
  if (/^(Software WebGL|Uploading )/.test(said.textContent)) said.style.display = "none";
})).observe(document.body, {childList: true, subtree: true});
