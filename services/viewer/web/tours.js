// Stored tours of the building: made, changed, ordered and deleted, and saved in its jobs file. A tour that is being written is the
// draft; it stays until it is saved or given up, whatever others save meanwhile.
import * as commands from './commands.js';
import {DAYS} from './names.js';
import {Orders, askTwice, say} from './orders.js';
import {t, translated} from './texts.js';

const $ = (id) => document.getElementById(id);
const IN_FORCE_MS = 3000;  // by then the job service has looked at the file
const MAX_STOPS = 20;
const STALE = t`somebody else has changed the tours meanwhile: look at them, and save again`;

const make = (tag, properties, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};

function tool(key, sign, title, press) {
  const made = make('button', {type: 'button', className: 'small', textContent: sign, title});
  made.setAttribute('aria-label', title);
  made.dataset.tour = key;
  made.addEventListener('click', press);
  return made;
}

// "Mo-Fr"; three and more in a row.
export function daysText(days) {
  const text = [];
  for (let first = 0; first < DAYS.length; ++first) {
    if (!days.includes(DAYS[first])) continue;
    let last = first;
    while (days.includes(DAYS[last + 1])) ++last;
    if (last - first < 2) last = first;
    text.push(last === first ? translated(DAYS[first]) : `${translated(DAYS[first])}–${translated(DAYS[last])}`);
    first = last;
  }
  return text.join(', ');
}

const written = ({name, at, days, stops}) => ({name, ...(at ? {at} : {}), ...(at && days.length < DAYS.length ? {days} : {}),
  stops: stops.map(({place, pause, text, photo}) => ({place, ...(pause ? {pause} : {}), ...(text ? {text} : {}), ...(photo ? {photo} : {})}))});

export class Tours {
  // `note(subject, text, tone, seconds)` says something; `known()`: the names of the tours that the job service has.
  constructor({note, known}) {
    Object.assign(this, {note, known, isOn: false, site: null, draft: null, places: [], listed: ''});
    this.orders = new Orders(commands.tours, STALE, {
      begin: () => { say('tours', t`Is being checked …`); this.hint(); },
      done: (order) => this.finish(order),
      asks: (order, found) => {
        this.refuse(t`Checking finds:`, found);
        if (this.draft) this.draft.accepts = order.action;  // pressed again it means yes
        this.hint();
      },
      refused: (why) => this.refuse(translated(why)),
    });
    $('tours-edit').addEventListener('click', () => this.open(!this.isOn));
    $('tours-close').addEventListener('click', () => this.open(false));
    $('tours-new').addEventListener('click', () => this.begin('', {name: '', at: '', days: [...DAYS], stops: []}));
    askTwice($('tours-undo'), t`Really undo it?`, () => this.send({action: 'undo'}));
    $('tours-cancel').addEventListener('click', () => this.setDraft(null));
    $('tours-add').addEventListener('click', () => this.addStop());
    $('tours-remove').addEventListener('click', () => this.send({action: 'remove_tour', name: this.draft.name}));
    $('tours-form').addEventListener('submit', (event) => { event.preventDefault(); this.save(); });
    $('tours-name').addEventListener('input', () => this.change({name: $('tours-name').value.trim()}));
    $('tours-at').addEventListener('input', () => this.change({at: $('tours-at').value}));
    for (const day of DAYS) $('tours-days').append(tool(`day ${day}`, translated(day), translated(day), () => this.turnDay(day)));
  }

  setPlaces(places) { this.places = places.map(({name}) => name); }

  // What the viewer says of the tours.
  show(site) {
    this.site = site;
    $('tours-edit').hidden = false;
    this.orders.look(site.orders);
    this.list();
    this.hint();
  }

  // A draft waits until it is opened again.
  open(isOn) {
    this.isOn = isOn;
    $('tours-edit').setAttribute('aria-pressed', String(isOn));
    $('tours-card').hidden = !isOn;
    this.list();
    if (isOn) $('tours-card').scrollIntoView({block: 'nearest'});
  }

  // ---- what is there

  list() {
    if (!this.site) return;
    const {tours, undo, objection} = this.site;
    $('tours-objection').textContent = objection;
    $('tours-objection').hidden = !objection;
    $('tours-undo').disabled = !undo;
    $('tours-undo').title = undo ?? '';
    const said = JSON.stringify(tours);
    if (said === this.listed) return;
    this.listed = said;
    this.fill($('tours-list'), tours.map((tour, i) => this.line(tour, i)));
  }

  // Puts other lines into a list; the focus stays where it was.
  fill(list, lines) {
    const focused = document.activeElement?.dataset.tour;
    list.replaceChildren(...lines);
    if (focused) [...list.querySelectorAll('[data-tour]')].find(({dataset}) => dataset.tour === focused)?.focus({preventScroll: true});
  }

  line(tour, i) {
    const {tours} = this.site;
    const when = tour.at ? `${tour.at}${tour.days.length < DAYS.length ? ` ${daysText(tour.days)}` : ''} · ` : '';
    const name = make('button', {type: 'button', className: 'name'}, make('b', {textContent: tour.name}),
      make('small', {textContent: `${when}${tour.stops.map(({place}) => place).join(', ')}`}));
    name.dataset.tour = `choose ${tour.name}`;
    name.addEventListener('click', () => this.choose(tour.name));
    const move = (before) => this.send({action: 'move_tour', name: tour.name, ...(before ? {before} : {})});
    const up = tool(`up ${tour.name}`, '↑', t`${tour.name}: one up`, () => move(tours[i - 1].name));
    const down = tool(`down ${tour.name}`, '↓', t`${tour.name}: one down`, () => move(tours[i + 2]?.name));
    up.disabled = i === 0;
    down.disabled = i === tours.length - 1;
    return make('li', {}, name, up, down);
  }

  choose(name) {
    const tour = this.site.tours.find((known) => known.name === name);
    if (tour) this.begin(name, {at: '', ...tour, days: [...tour.days], stops: tour.stops.map((stop) => ({...stop}))});
  }

  // ---- the draft

  begin(name, item) {
    this.setDraft({name, item, version: this.site.version, accepts: ''});
    $('tours-card').scrollIntoView({block: 'start'});
    if (!matchMedia('(pointer: coarse)').matches) $('tours-name').focus({preventScroll: true});
  }

  setDraft(draft) {
    this.draft = draft;
    this.orders.forget();
    $('tours-start').hidden = Boolean(draft);
    $('tours-form').hidden = !draft;
    say('tours', '');
    if (!draft) return;
    $('tours-name').value = draft.item.name;
    $('tours-at').value = draft.item.at;
    $('tours-remove').hidden = !draft.name;
    this.change({});
    this.listStops();
  }

  change(what) {
    const {item} = this.draft;
    Object.assign(item, what);
    this.draft.accepts = '';
    say('tours', '');
    $('tours-days').hidden = $('tours-alone').hidden = !item.at;
    for (const chip of $('tours-days').children) chip.setAttribute('aria-pressed', String(item.days.includes(chip.dataset.tour.slice(4))));
    this.hint();
  }

  turnDay(day) {
    const {days} = this.draft.item;
    this.change({days: DAYS.filter((known) => days.includes(known) !== (known === day))});
  }

  addStop() {
    const {stops} = this.draft.item;
    stops.push({place: '', pause: 0, text: '', photo: false});
    this.change({stops});
    this.listStops();
    $('tours-stops').lastChild.querySelector('select').focus();
  }

  listStops() {
    this.fill($('tours-stops'), this.draft.item.stops.map((stop, i) => this.stopLine(stop, i)));
    $('tours-add').hidden = this.draft.item.stops.length >= MAX_STOPS;
  }

  stopLine(stop, i) {
    const {stops} = this.draft.item;
    const names = ['', ...this.places, ...(this.places.includes(stop.place) ? [] : [stop.place])];
    const place = make('select', {}, ...[...new Set(names)].map((name) => new Option(name || t`Where to?`, name)));
    place.value = stop.place;
    const pause = make('input', {type: 'number', min: 0, max: 3600, step: 'any', value: stop.pause || ''});
    const text = make('input', {type: 'text', maxLength: 200, value: stop.text, autocomplete: 'off'});
    const field = (key, input, label, read) => {
      input.setAttribute('aria-label', label);
      input.dataset.tour = `${key} ${i}`;
      input.addEventListener('input', () => { stop[key] = read(input.value); this.change({}); });
      return input;
    };
    field('place', place, t`Place of stop ${i + 1}`, String);
    field('pause', pause, t`Pause at stop ${i + 1}, seconds`, Number);
    field('text', text, t`Said at stop ${i + 1}`, (value) => value.trim());
    pause.placeholder = t`pause, s`;
    text.placeholder = t`What it says there`;
    const move = (to) => { stops.splice(to, 0, ...stops.splice(i, 1)); this.change({}); this.listStops(); };
    const up = tool(`stop up ${i}`, '↑', t`Stop ${i + 1} one up`, () => move(i - 1));
    const down = tool(`stop down ${i}`, '↓', t`Stop ${i + 1} one down`, () => move(i + 1));
    const leave = tool(`stop leave ${i}`, '✕', t`Remove stop ${i + 1}`, () => { stops.splice(i, 1); this.change({}); this.listStops(); });
    up.disabled = i === 0;
    down.disabled = i === stops.length - 1;
    const photo = make('input', {type: 'checkbox', checked: stop.photo});
    photo.dataset.tour = `photo ${i}`;
    photo.addEventListener('change', () => { stop.photo = photo.checked; this.change({}); });
    return make('li', {}, make('div', {className: 'row'}, place, up, down, leave), make('div', {className: 'row'}, pause, text),
      make('label', {className: 'check'}, photo, t`keep the camera's picture there`));
  }

  objection() {
    const {name, at, days, stops} = this.draft.item;
    if (!name) return t`It needs a name.`;
    if (stops.length === 0) return t`It needs a stop.`;
    if (stops.some(({place}) => !place)) return t`Choose a place for each stop.`;
    if (stops.some(({pause}) => !(pause >= 0 && pause <= 3600))) return t`A pause is an hour at most.`;
    return at && days.length === 0 ? t`Choose its days.` : '';
  }

  hint() {
    if (!this.draft) return;
    const {version, accepts} = this.draft;
    const isWaiting = Boolean(this.orders.waiting);
    const isOld = version !== this.site.version && !isWaiting;
    const text = [isOld ? t`Somebody else has changed the tours meanwhile.` : '', this.objection()].filter(Boolean).join(' ');
    $('tours-hint').textContent = text;
    $('tours-hint').hidden = !text;
    $('tours-save').disabled = isWaiting || Boolean(this.objection());
    $('tours-save').textContent = accepts === 'set_tour' ? t`Save all the same` : t`Save`;
    $('tours-remove').disabled = isWaiting;
  }

  // ---- saving

  save() {
    const {name, item, accepts} = this.draft;
    if (this.objection()) return;
    this.send({action: 'set_tour', tour: written(item), ...(name ? {name} : {}), ...(accepts === 'set_tour' ? {accept: true} : {})});
  }

  send(order) { this.orders.send({...order, version: this.draft?.version ?? this.site.version}); }

  finish({action}) {
    if (action !== 'move_tour') this.setDraft(null);
    this.note('tours', action === 'undo' ? t`The last change is undone.` : t`Saved in the building's jobs file.`, '', 4);
    setTimeout(() => {
      const isInForce = JSON.stringify(this.known()) === JSON.stringify(this.site.tours.map(({name}) => name));
      this.note('tours', isInForce ? t`The robot goes by it.` : t`The job service has not taken it over yet: does the process jobs run?`,
        isInForce ? '' : 'bad', 4);
    }, IN_FORCE_MS);
  }

  // The draft stays; what is saved next is for the tours as they are now.
  refuse(why, found = []) {
    if (this.draft) this.draft.version = this.site.version;
    say('tours', why, found);
    if (!this.draft) this.note('tours', why, 'bad');
    this.hint();
  }
}
