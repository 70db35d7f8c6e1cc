// Zones and places of the building: drawn on the map, saved in its file. What is being drawn is the draft; it stays until it
// is saved or given up, whatever others save meanwhile.
import * as commands from './commands.js';
import {corners, crosses, drawDraft, gripsOf, isInside, middleOf} from './drafts.js';
import {ZONE_KINDS, hoursOf} from './names.js';
import {Orders, askTwice, say} from './orders.js';
import {t, translated} from './texts.js';

const $ = (id) => document.getElementById(id);
const PLACE_PX = 20;         // a tap as near as that to a place means the place
const IN_FORCE_MS = 3000;    // by then every process has spoken
const STALE = t`somebody else has changed the building meanwhile: look at it, and save again`;
const rounded = (value) => Math.round(value * 100) / 100;
const turned = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));

const written = {
  zone: ({name, kind, polygon, speed, direction, hours, days}) => ({name, kind, polygon: polygon.map((corner) => corner.map(rounded)),
    ...(kind === 'slow' ? {speed} : {}), ...(kind === 'one-way' ? {direction: turned(direction)} : {}), ...(hours ? {hours} : {}), ...(days ? {days} : {})}),
  place: ({name, x, y, theta}) => ({name, x: rounded(x), y: rounded(y), ...(theta === undefined ? {} : {theta: turned(theta)})}),
};

export class Editor {
  // `note(subject, text, tone, seconds)` says something; `turn(isOn)`: taps on the map are for this one, or no longer.
  constructor({view, note, redraw, turn}) {
    Object.assign(this, {view, note, redraw, turn, isOn: false, site: null, draft: null});
    this.orders = new Orders(commands.building, STALE, {
      begin: () => { say('edit', t`Is being checked …`); this.hint(); },
      done: (order) => this.finish(order),
      asks: (order, found) => {
        this.refuse(t`Checking the building finds:`, found);
        if (this.draft) this.draft.accepts = order.action;  // pressed again it means yes
        this.hint();
      },
      refused: (why) => this.refuse(translated(why)),
    });
    for (const [kind, word] of Object.entries(ZONE_KINDS)) $('edit-kind').append(new Option(translated(word), kind));
    view.addEventListener('tap', ({detail: [x, y]}) => { if (this.isOn) this.tap(x, y); });
    view.addEventListener('grip', ({detail: {grip, at}}) => this.pull(grip, at));
    $('edit').addEventListener('click', () => this.open(!this.isOn));
    $('edit-close').addEventListener('click', () => this.open(false));
    $('edit-zone').addEventListener('click', () => this.begin('zone', '', {name: '', kind: 'keep-out', polygon: [], speed: 0.2, direction: 0}));
    $('edit-place').addEventListener('click', () => this.begin('place', '', {name: '', x: undefined, y: undefined, theta: undefined}));
    askTwice($('edit-undo'), t`Really undo it?`, () => this.send({action: 'undo'}));
    $('edit-cancel').addEventListener('click', () => this.setDraft(null));
    $('edit-back').addEventListener('click', () => { this.draft.item.polygon.splice(this.draft.corner, 1); this.changed(); });
    $('edit-remove').addEventListener('click', () => this.remove());
    $('edit-form').addEventListener('submit', (event) => { event.preventDefault(); this.save(); });
    for (const field of ['name', 'kind', 'speed', 'heading', 'hours', 'days', 'corners']) $(`edit-${field}`).addEventListener('input', () => this.read(field));
  }

  // What the viewer says of the building.
  show(site) {
    this.site = site;
    $('edit').hidden = false;
    this.orders.look(site.orders);
    this.list();
    this.hint();
  }

  // A draft waits until it is opened again.
  open(isOn) {
    this.isOn = isOn;
    $('edit').setAttribute('aria-pressed', String(isOn));
    $('edit-card').hidden = !isOn;
    document.body.classList.toggle('editing', isOn);
    this.turn(isOn);
    if (isOn) this.showCard();
    this.list();
    this.redraw();
  }

  showCard() {
    $('side').scrollTop = 0;
    scrollTo({top: 0});  // on a phone: map and card lie side by side there
  }

  // ---- what is there

  list() {
    if (!this.site || !this.isOn) return;
    const {zones, places, undo, objection} = this.site;
    $('edit-objection').textContent = objection;
    $('edit-objection').hidden = !objection;
    $('edit-undo').disabled = !undo;
    $('edit-undo').title = undo ?? '';
    const items = [...zones.map((item) => ['zone', item]), ...places.map((item) => ['place', item])];
    const names = JSON.stringify(items.map(([what, {name, kind, hours, days, in_force}]) => [what, name, kind, hours, days, in_force]));
    if (names === this.listed) return;
    this.listed = names;
    const focused = document.activeElement?.dataset.edit;
    $('edit-list').replaceChildren(...items.map(([what, item]) => {
      const chip = Object.assign(document.createElement('button'), {type: 'button', textContent: item.name,
        title: what === 'zone' ? [translated(ZONE_KINDS[item.kind]), hoursOf(item)].filter(Boolean).join(', ') : t`place`});
      chip.dataset.edit = `${what} ${item.name}`;
      chip.dataset.kind = item.kind ?? 'place';
      chip.classList.toggle('resting', item.in_force === false);
      chip.addEventListener('click', () => this.choose(what, item.name));
      return chip;
    }));
    if (focused) [...$('edit-list').children].find(({dataset}) => dataset.edit === focused)?.focus({preventScroll: true});
  }

  choose(what, name) {
    const item = this.site[`${what}s`].find((known) => known.name === name);
    if (!item) return;
    this.begin(what, name, what === 'zone' ? {speed: 0.2, direction: 0, ...item, polygon: item.polygon.map((corner) => [...corner])} : {...item});
    const [x, y] = middleOf(this.draft);
    const [px, py] = this.view.toScreen(x, y);
    if (px < 0 || py < 0 || px > this.view.width || py > this.view.height) this.view.centre = [x, y];
  }

  tap(x, y) {
    const {draft} = this;
    if (draft?.what === 'place') {
      Object.assign(draft.item, {x, y});
    } else if (draft) {
      if (draft.name) return;  // its corners are dragged
      draft.item.polygon.push([x, y]);
      draft.corner = draft.item.polygon.length - 1;
    } else {
      this.chooseAt(x, y);
      return;
    }
    this.changed();
  }

  // The place there, or the zone, the small one where several lie over each other.
  chooseAt(x, y) {
    const {zones, places} = this.site;
    const [px, py] = this.view.toScreen(x, y);
    const place = places.find((known) => {
      const [qx, qy] = this.view.toScreen(known.x, known.y);
      return Math.hypot(qx - px, qy - py) < PLACE_PX;
    });
    const size = ({polygon}) => Math.max(...polygon.map(([u, v]) => Math.hypot(u - polygon[0][0], v - polygon[0][1])));
    const [zone] = zones.filter(({polygon}) => isInside(polygon, x, y)).sort((a, b) => size(a) - size(b));
    if (place) this.choose('place', place.name);
    else if (zone) this.choose('zone', zone.name);
  }

  // ---- the draft

  begin(what, name, item) {
    this.setDraft({what, name, item, corner: 0, version: this.site.version, accepts: ''});
    this.showCard();
    if (!matchMedia('(pointer: coarse)').matches) $('edit-name').focus({preventScroll: true});  // no keyboard over a phone's map
  }

  setDraft(draft) {
    this.draft = draft;
    this.orders.forget();
    $('edit-start').hidden = Boolean(draft);
    $('edit-form').hidden = !draft;
    if (draft) {
      const {name, kind, speed, hours, days} = draft.item;
      $('edit-name').value = name;
      $('edit-kind').value = kind ?? 'keep-out';
      $('edit-speed').value = speed ?? '';
      $('edit-hours').value = hours ?? '';
      $('edit-days').value = days ?? '';
    }
    this.changed();
  }

  // Something was dragged, tapped or written: the fields show it, but for the one that is written in.
  changed(field = '') {
    const {draft} = this;
    this.redraw();
    if (!draft) return;
    draft.accepts = '';
    say('edit', '');
    const {what, item, name} = draft;
    const isZone = what === 'zone';
    const heading = isZone ? item.direction : item.theta;
    for (const [id, isShown] of [['kind', isZone], ['speed', item.kind === 'slow'], ['heading', !isZone || item.kind === 'one-way'],
      ['hours', isZone], ['days', isZone]]) {
      $(`edit-${id}`).closest('label').hidden = !isShown;
    }
    $('edit-heading-word').textContent = isZone ? t`Direction, degrees` : t`Heading, degrees`;
    if (field !== 'heading') $('edit-heading').value = heading === undefined ? '' : Math.round(heading * 180 / Math.PI);
    if (field !== 'corners') $('edit-corners').value = corners(draft).map((point) => point.map((value) => value.toFixed(2)).join(' ')).join('\n');
    $('edit-back').hidden = !isZone || item.polygon.length === 0;
    $('edit-remove').hidden = !name;
    this.hint();
  }

  read(field) {
    const {draft} = this;
    const {item} = draft;
    const value = $(`edit-${field}`).value.trim();
    const degrees = value === '' ? undefined : Number(value) * Math.PI / 180;
    if (field === 'name') item.name = value;
    if (field === 'kind') item.kind = value;
    if (field === 'speed') item.speed = Number(value);
    if (field === 'hours' || field === 'days') item[field] = value;
    if (field === 'heading') item[draft.what === 'zone' ? 'direction' : 'theta'] = draft.what === 'zone' ? degrees ?? 0 : degrees;
    if (field === 'corners') {
      const points = value.split('\n').map((line) => line.trim().split(/[\s,;]+/).map(Number)).filter((point) => point.length === 2 && point.every(Number.isFinite));
      if (draft.what === 'zone') item.polygon = points;
      else [item.x, item.y] = points[0] ?? [];
    }
    this.changed(field);
  }

  pull(grip, [x, y]) {
    const {item} = this.draft ?? {};
    if (!item) return;
    const [u, v] = middleOf(this.draft);
    if (grip.key === 'turn') item[this.draft.what === 'zone' ? 'direction' : 'theta'] = Math.atan2(y - v, x - u);
    else if (grip.key === 'all') item.polygon = item.polygon.map(([a, b]) => [a + x - u, b + y - v]);
    else if (grip.key === 'point') Object.assign(item, {x, y});
    else {
      if (grip.isNew) item.polygon.splice(grip.key, 0, [x, y]);  // in the middle of an edge
      grip.isNew = false;
      item.polygon[grip.key] = [x, y];
      this.draft.corner = grip.key;
    }
    this.changed();
  }

  objection() {
    const {what, item} = this.draft;
    if (what === 'place' && item.x === undefined) return t`Tap the map where the place is.`;
    if (what === 'zone' && item.polygon.length < 3) return t`Tap the zone's corners on the map: ${item.polygon.length} so far.`;
    if (what === 'zone' && crosses(item.polygon)) return t`The edges cross: drag a corner.`;
    return item.name ? '' : t`It needs a name.`;
  }

  hint() {
    if (!this.draft) return;
    const {what, name, version} = this.draft;
    const isOld = version !== this.site.version && !this.orders.waiting;
    const how = what === 'place' ? t`Drag the point, or tap where it is to be.` : name ? t`Drag corners; drag the dot of an edge for a new corner, the cross to move all.`
      : t`Tap more corners, or drag them.`;
    $('edit-hint').textContent = `${isOld ? `${t`Somebody else has changed the building meanwhile.`} ` : ''}${this.objection() || how}`;
    $('edit-save').disabled = Boolean(this.objection() || this.orders.waiting);
    $('edit-save').textContent = this.draft.accepts === `set_${what}` ? t`Save all the same` : t`Save`;
    $('edit-remove').textContent = this.draft.accepts === `remove_${what}` ? t`Delete all the same` : t`Delete`;
    $('edit-remove').disabled = Boolean(this.orders.waiting);
  }

  // ---- saving

  save() {
    const {what, item} = this.draft;
    if (!this.objection()) this.send({action: `set_${what}`, [what]: written[what](item)});
  }

  remove() { this.send({action: `remove_${this.draft.what}`}); }

  send(body) {
    const {draft} = this;
    this.orders.send({...body, version: draft?.version ?? this.site.version, ...(draft?.name ? {name: draft.name} : {}),
      ...(draft?.accepts === body.action ? {accept: true} : {})});
  }

  finish({action}) {
    this.showCard();
    this.setDraft(null);
    this.note('building', action === 'undo' ? t`The last change is undone.` : t`Saved in the building's file.`, '', 4);
    setTimeout(() => this.note('building', this.site.objection || t`The robot goes by it.`, this.site.objection ? 'bad' : '', 4), IN_FORCE_MS);
  }

  // The draft stays; what is saved next is for the building as it is now.
  refuse(why, found = []) {
    this.showCard();
    if (this.draft) this.draft.version = this.site.version;
    say('edit', why, found);
    if (!this.draft) this.note('building', why, 'bad');
    this.hint();
  }

  draw(context, colours) {
    this.view.grips = this.isOn && this.draft ? gripsOf(this.draft, this.view) : [];
    if (this.isOn && this.draft) drawDraft(context, this.view, this.draft, this.view.grips, colours);
  }
}
