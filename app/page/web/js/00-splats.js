// The viewer makes a sorter of splats ready as soon as it is there, of which this page shows none. It would need the right
// to run any text as a script, which the page does not have (Content-Security-Policy): so it waits for ever.
(() => {
  const fetched = window.fetch.bind(window);
  window.fetch = (what, ...how) => String(what).startsWith("data:application/wasm") ? new Promise(() => {}) : fetched(what, ...how);
})();
