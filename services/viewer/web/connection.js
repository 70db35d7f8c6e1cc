// The stream of events from the viewer, and how fresh it is.
const SILENT_MS = 1500;

export class Connection extends EventTarget {
  constructor() {
    super();
    this.lastHeard = 0;
    this.isOpen = false;
    this.open();
    setInterval(() => this.watch(), 500);
  }

  open() {
    this.source?.close();
    this.opened = performance.now();
    this.source = new EventSource('events');
    for (const name of ['state', 'nodes', 'hypotheses', 'path', 'picture', 'tile', 'processes', 'jobs', 'survey', 'building', 'tours', 'playback']) {
      this.source.addEventListener(name, (event) => {
        this.lastHeard = performance.now();
        let data;
        try { data = JSON.parse(event.data); } catch { return; }
        if (name === 'state') this.clock = {utime: data.utime, at: performance.now()};
        this.dispatchEvent(new CustomEvent(name, {detail: data}));
      });
    }
  }

  // An event source can hang in a dead connection, or give up after an error answer: then a new one is opened.
  watch() {
    const now = performance.now();
    const silent = now - Math.max(this.lastHeard, this.opened);
    if (silent > 5000 || (this.source.readyState === EventSource.CLOSED && silent > 1000)) this.open();
    this.dispatchEvent(new CustomEvent('watch'));
  }

  // [s] since the viewer said anything; infinite before it did.
  silence() {
    return this.lastHeard ? (performance.now() - this.lastHeard) / 1000 : Infinity;
  }

  // [us] the clock of the viewer's host, behind by as long as a message takes to come here.
  serverTime() {
    return this.clock ? Math.round(this.clock.utime + 1000 * (performance.now() - this.clock.at)) : 0;
  }

  isSilent() { return this.silence() * 1000 > SILENT_MS; }
}
