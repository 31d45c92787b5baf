// The address at which the viewer asks for its websocket. It ends with a slash: the viewer would ask without, and the proxy of
// a lab below a path leads from there to the slash, where no websocket follows. It says the page's language and what is known
// before there is a page, so that its first picture is what was asked for: cookies are those of all tabs.
let firstMessage = {};
(() => {
  const LONGEST = 3000, post = Worker.prototype.postMessage;
  const address = () => {
    const asked = new URLSearchParams({lang: document.documentElement.lang, first: JSON.stringify(firstMessage)});
    if (`${asked}`.length > LONGEST) asked.delete("first");
    return `${location.origin}${location.pathname}/`.replace(/^http/, "ws").replace(/\/+$/, "/") + `?${asked}`;
  };
  Worker.prototype.postMessage = function (what, ...how) {
    const asks = ["set_server", "retry"].includes(what?.type);
    post.call(this, asks ? {type: "set_server", server: address()} : what, ...how);
  };
})();
