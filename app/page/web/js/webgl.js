// Without WebGL the viewer fails and shows nothing, not even its panel: the page says why, and asks the server no more. To
// try it costs some milliseconds, so that is for a page that is late.
setTimeout(() => {
  if (document.body.classList.contains("lab-to-see") || document.createElement("canvas").getContext("webgl2")) return;
  const said = document.querySelector("#lab-ground span");
  document.body.classList.add("lab-flat");
  said.firstChild.data = tr("The stage needs WebGL, which this browser does not have.");
  said.querySelector("small").textContent = tr("Switch on graphics acceleration in the browser's settings (System or Performance) and restart it, or take another browser. Lessons exported to a file play without WebGL.");
  Worker.prototype.postMessage = () => {};
}, 2000);
