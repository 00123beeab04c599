// The search without a worker, which browsers do not start for a page that is opened as a file: it runs in a hidden frame.
window.Worker = class extends EventTarget {
  constructor(url) {
    super();
    const frame = document.createElement("iframe");
    frame.hidden = true;
    document.body.appendChild(frame);
    this.frame = frame.contentWindow;
    this.frame.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
    const script = this.frame.document.createElement("script");
    script.src = url;
    this.loaded = new Promise((resolve) => (script.onload = resolve));
    this.frame.document.head.appendChild(script);
  }

  postMessage(data) {
    this.loaded.then(() => this.frame.dispatchEvent(new this.frame.MessageEvent("message", { data })));
  }

  terminate() {
    this.frame.frameElement.remove();
  }
};
