// Jobs: ordered in three taps, confirmed and answered by whoever stands beside the robot.
import * as commands from './commands.js';
import {JOB_KINDS} from './names.js';
import {t, translated} from './texts.js';

const $ = (id) => document.getElementById(id);
const MANY_PLACES = 12;      // from then on they are searched
const SHOWN_OVER = 2;        // of those that are over
const PATIENCE_MS = 10_000;  // a request is repeated for so long
const SILENT_S = 4;          // it speaks once a second
const STOPS = {guide: 1, go: 1, carry: 2};

function button(key, text, press, look = '') {
  const made = Object.assign(document.createElement('button'), {textContent: text, className: look});
  made.dataset.job = key;
  made.addEventListener('click', press);
  return made;
}

export class Jobs {
  // `ask(subject, send, what)` sends a request and reports; `note(subject, text, tone)` says something.
  constructor(ask, note) {
    Object.assign(this, {ask, note, places: [], tours: [], queue: [], photos: [], last: null, order: null, sent: new Map(), shown: ''});
    for (const kind of ['guide', 'carry', 'tour', 'home']) {
      $('job-kinds').append(button(kind, translated(JOB_KINDS[kind]), () => this.begin(kind)));
    }
    $('job-search').addEventListener('input', () => this.search());
    $('job-close').addEventListener('click', () => this.choose(null));
    setInterval(() => this.complain(), 1000);
  }

  setPlaces(places) { this.places = places.map(({name}) => name); }

  // ---- ordering

  begin(kind) {
    if (kind === 'home') this.send({action: 'add', kind});
    else this.choose({kind, stops: []});
  }

  choose(order) {
    this.order = order;
    $('job-order').hidden = !order;
    if (!order) return;
    const {kind, stops} = order;
    const isSecond = stops.length > 0;
    $('job-order-text').textContent = kind === 'tour' ? t`Which tour?` : kind === 'guide' ? t`Where to?`
      : isSecond ? t`From ${stops[0]}: where to?` : t`Where is it fetched?`;
    const names = kind === 'tour' ? this.tours : this.places;
    $('job-choices').replaceChildren(...names.map((name) => button(`choice ${name}`, name, () => this.take(name))));
    $('job-choices').dataset.empty = kind === 'tour' ? t`No tours are stored yet: Edit tours makes one.` : '';
    $('job-search').hidden = names.length <= MANY_PLACES;
    $('job-search').value = '';
    ($('job-search').hidden ? $('job-choices').firstChild : $('job-search'))?.focus({preventScroll: true});
    $('job-order').scrollIntoView({block: 'nearest'});
  }

  search() {
    const wanted = $('job-search').value.trim().toLowerCase();
    for (const choice of $('job-choices').children) choice.hidden = !choice.textContent.toLowerCase().includes(wanted);
  }

  take(name) {
    const {kind, stops} = this.order;
    const next = [...stops, name];
    if (kind === 'tour') this.send({action: 'add', kind, tour: name});
    else if (next.length < STOPS[kind]) { this.choose({kind, stops: next}); return; }
    else this.send({action: 'add', kind, stops: next.map((place) => ({place}))});
    this.choose(null);
  }

  send(body) {
    this.ask('job', async () => { this.sent.set(await commands.job(body), performance.now()); }, '');
  }

  // ---- what became of it

  show(said) {
    const {jobs, requests, tours} = said;
    this.last = {...said, requests: []};
    this.tours = tours;
    this.queue = jobs;
    $('jobs-card').hidden = false;
    for (const {id, objection} of requests) {
      if (this.sent.delete(id) && objection) this.note('job', objection, 'bad');
    }
    const waiting = jobs.filter(({position}) => position >= 0);
    const over = jobs.filter(({position}) => position < 0).slice(0, SHOWN_OVER);
    const stops = JSON.stringify(jobs.map(({id, stop, state}) => [id, stop, state]));
    if (stops !== this.stops) { this.stops = stops; this.renewPhotos(); }
    const shown = JSON.stringify([waiting, over]);
    if (shown === this.shown) return;
    this.shown = shown;
    const focused = document.activeElement?.dataset.job;
    $('job-list').replaceChildren(...waiting.map((job) => this.line(job)), ...over.map((job) => this.line(job)));
    if (focused) [...$('job-list').querySelectorAll('[data-job]')].find(({dataset}) => dataset.job === focused)?.focus({preventScroll: true});
  }

  // What a service said that is silent now is not shown as if it still held.
  watch({JOB_STATUS: age}) {
    const isSilent = age > SILENT_S;
    $('job-list').classList.toggle('old', isSilent);
    $('jobs-word').textContent = isSilent ? t`silent for ${Math.round(age)} s` : '';
  }

  complain() {
    for (const [id, since] of this.sent) {
      if (performance.now() - since > PATIENCE_MS) {
        this.sent.delete(id);
        this.note('job', t`No answer from the job service: does the process jobs run?`, 'bad');
      }
    }
  }

  // Pictures that were kept at its stops, by their names: STAMP-JOB-STOP.
  photosOf({id, stops}) {
    return this.photos.filter((name) => name.split('-')[1] === String(id)).map((name) => {
      const link = Object.assign(document.createElement('a'), {href: `api/file?kind=photo&name=${name}.jpg`, target: '_blank',
        textContent: t`Picture: ${stops[Number(name.split('-')[2])] ?? ''}`, className: 'photo'});
      link.dataset.job = `photo ${name}`;
      return link;
    });
  }

  // They come to be while a job is at a stop, or goes on from there.
  async renewPhotos() {
    const said = await fetch('api/files').then((answer) => answer.json()).catch(() => null);
    const names = said?.photos?.map(({name}) => name).sort() ?? [];
    if (names.join() === this.photos.join()) return;
    this.photos = names;
    this.shown = '';
    if (this.last) this.show(this.last);
  }

  line(job) {
    const line = document.createElement('li');
    line.dataset.state = job.state;
    const title = Object.assign(document.createElement('b'), {textContent: `${translated(JOB_KINDS[job.kind])}: ${job.stops.join(', ')}`});
    const sentence = Object.assign(document.createElement('p'), {textContent: job.sentence});
    line.append(title, sentence);
    if (job.text) line.append(Object.assign(document.createElement('p'), {textContent: job.text, className: 'said'}));
    line.append(...this.photosOf(job));
    if (job.position < 0) return line;
    const row = Object.assign(document.createElement('div'), {className: 'row'});
    const say = (action, word, look = '') => button(`${job.id} ${action} ${word}`, translated(word), () => this.send({action, job: job.id, word}), look);
    if (job.waits_for) row.append(say('confirm', job.waits_for, 'primary'));
    if (job.kind === 'guide' && job.state === 'driving') row.append(say('confirm', 'here', 'primary'), say('confirm', 'wait'));
    row.append(...job.answers.map((word, i) => say('answer', word, i === 0 ? 'primary' : '')));
    row.append(button(`${job.id} cancel`, t`Cancel job`, () => this.send({action: 'cancel', job: job.id}), 'small'));
    line.append(row);
    return line;
  }
}
