// The viewer asks for its websocket at the page's address less its last slash. From there the proxy of a lab that is below
// a path leads to the slash, and no websocket follows: so it asks with the slash.
(() => {
  const post = Worker.prototype.postMessage;
  Worker.prototype.postMessage = function (what, ...how) {
    if (what?.type === "set_server") what.server = `${location.origin}${location.pathname}/`.replace(/^http/, "ws").replace(/\/+$/, "/");
    post.call(this, what, ...how);
  };
})();
