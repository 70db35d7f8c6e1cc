// Where to go: a place by its name, a tap on the map, or a route of several stops.
import * as commands from './commands.js';
import {t} from './texts.js';

const $ = (id) => document.getElementById(id);
const PLACE_PX = 16;         // a tap as near as that to a place means the place,
const PLACE_M = 0.7;         // [m] and so near, when the map is seen from afar
const MANY_PLACES = 12;      // from then on they are searched
const STEP = Math.PI / 12;   // [rad] of a heading by key
const EDGE_PX = 8;

export const asPose = ({x, y, theta, place}) => (place ? {place} : theta === undefined ? {x, y} : {x, y, theta});
const nameOf = ({x, y, place}) => place ?? `${x.toFixed(1)}, ${y.toFixed(1)} m`;

export class Goals {
  // `ask(subject, send, what)` sends a request and reports; `note(subject, text, tone)` says something; `isTight(x, y)`: a
  // wall is nearer than half the robot's width.
  constructor({view, ask, note, redraw, isTight}) {
    Object.assign(this, {view, ask, note, redraw, isTight, places: [], draft: null, route: [], isOff: false});
    view.addEventListener('tap', ({detail: [x, y]}) => this.tap(x, y));
    view.addEventListener('handle', ({detail: [x, y]}) => {
      if (this.draft) this.turnTo(Math.atan2(y - this.draft.y, x - this.draft.x));
    });
    view.addEventListener('change', () => { if (this.draft) this.putBeside(this.draft); });
    $('ask-go').addEventListener('click', () => this.goThere());
    $('ask-add').addEventListener('click', () => this.addStop());
    $('ask-here').addEventListener('click', () => this.tellPose());
    $('ask-close').addEventListener('click', () => this.setDraft(null));
    $('ask-left').addEventListener('click', () => this.turnTo((this.draft.theta ?? 0) + STEP));
    $('ask-right').addEventListener('click', () => this.turnTo((this.draft.theta ?? 0) - STEP));
    addEventListener('keydown', (event) => { if (event.key === 'Escape') this.setDraft(null); });
    $('route-go').addEventListener('click', () => {
      const loop = $('route-loop').checked;
      ask('route', () => commands.go(this.route.map(asPose), loop, $('route-skip').checked), '');
    });
    $('route-clear').addEventListener('click', () => this.setRoute([]));
    $('place-search').addEventListener('input', () => this.search($('place-search').value));
  }

  // There is no robot to be sent anywhere.
  turnOff() { this.isOff = true; }
  // Taps on the map are for somebody else, or no longer.
  giveWay(isOn) {
    this.isOff = isOn;
    if (isOn) this.setDraft(null);
  }

  setPlaces(places) {
    this.places = places;
    $('places').replaceChildren(...places.map((place) => {
      const chip = Object.assign(document.createElement('button'), {textContent: place.name});
      chip.addEventListener('click', () => this.ask('go', () => commands.go([{place: place.name}]), t`to ${place.name}`));
      return chip;
    }));
    $('place-search').hidden = places.length <= MANY_PLACES;
    $('place-search').placeholder = t`Search ${places.length} places`;
  }

  search(words) {
    const wanted = words.trim().toLowerCase();
    for (const chip of $('places').children) chip.hidden = !chip.textContent.toLowerCase().includes(wanted);
  }

  // Somebody chose a point of the map, or a place on it.
  tap(x, y) {
    if (this.isOff) return;
    const [px, py] = this.view.toScreen(x, y);
    const place = this.places.find((known) => {
      const [qx, qy] = this.view.toScreen(known.x, known.y);
      return Math.hypot(qx - px, qy - py) < PLACE_PX && Math.hypot(known.x - x, known.y - y) < PLACE_M;
    });
    this.setDraft(place ? {x: place.x, y: place.y, theta: place.theta, place: place.name} : {x, y, theta: undefined});
  }

  turnTo(theta) {
    this.setDraft({x: this.draft.x, y: this.draft.y, theta: Math.atan2(Math.sin(theta), Math.cos(theta))});
  }

  setDraft(next) {
    this.draft = next;
    $('ask').hidden = !next;
    if (next) {
      const heading = next.theta === undefined ? '' : `, ${Math.round(next.theta * 180 / Math.PI)}°`;
      $('ask-text').textContent = `${nameOf(next)}${next.place ? '' : heading}`;
      this.putBeside(next);
    }
    this.redraw();
  }

  // The sheet lies below the tap, or above it where there is no room; never over the goal itself.
  putBeside({x, y}) {
    const sheet = $('ask');
    const [px, py] = this.view.toScreen(x, y);
    const [width, height] = [sheet.offsetWidth, sheet.offsetHeight];
    const reach = 60;  // the knob's circle
    const isAbove = py + reach + height + EDGE_PX > this.view.height;
    const top = isAbove ? Math.max(EDGE_PX, py - reach - height) : py + reach;
    sheet.style.left = `${Math.min(Math.max(px - width / 2, EDGE_PX), Math.max(EDGE_PX, this.view.width - width - EDGE_PX))}px`;
    sheet.style.top = `${top}px`;
  }

  goThere() {
    const {draft} = this;
    this.setDraft(null);
    this.ask('go', () => commands.go([asPose(draft)]), t`to ${nameOf(draft)}`);
  }

  addStop() {
    const stop = this.draft;
    if (this.isTight(stop.x, stop.y)) {
      this.note('route', t`Stop ${this.route.length + 1} lies too near a wall: the robot may not get there.`, 'warn');
    }
    this.setRoute([...this.route, stop]);
    this.setDraft(null);
  }

  tellPose() {
    const {x, y, theta} = this.draft;
    if (theta === undefined) {
      this.note('pose', t`Turn it to where the robot looks first: drag the knob.`, 'warn');
      return;
    }
    this.setDraft(null);
    this.ask('pose', () => commands.initialPose(x, y, theta), t`told to the localizer`);
  }

  setRoute(next) {
    this.route = next;
    $('route').hidden = next.length === 0;
    $('route-stops').replaceChildren(...next.map((stop) => {
      const isTight = this.isTight(stop.x, stop.y);
      return Object.assign(document.createElement('li'),
        {textContent: nameOf(stop) + (isTight ? t` (too near a wall?)` : ''), className: isTight ? 'warn' : ''});
    }));
    this.redraw();
  }
}
