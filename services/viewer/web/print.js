// Codes for a wall: what a visitor can ask of the robot at a place. They lead to the viewer's page, which offers the job.
import * as commands from './commands.js';
import {OFFERS, addressOf} from './offer.js';
import {speak, t} from './texts.js';

const $ = (id) => document.getElementById(id);
const LOOPBACK = /^(localhost|127\.[\d.]+|\[::1\])$/;

speak(null);
const settings = await commands.settings;
const {role} = await commands.ownRole();
const known = await fetch('building.json').then((answer) => answer.json());
const wanted = new URLSearchParams(location.search).get('place');

const warnings = [];
if (LOOPBACK.test(location.hostname)) warnings.push(t`This page was opened on the robot's own machine: put the address here that phones use, as scripts/view --listen prints it.`);
if (settings.needs_token && role !== 'drive') {
  warnings.push(role === 'administer'
    ? t`The codes hold no token, so visitors may look and press STOP, no more. The token of this page may administer and is not printed: open this page with one to drive (scripts/view --drive-token-file).`
    : t`The codes hold no token, so visitors may look and press STOP, no more. Open this page with a token to drive (scripts/view --drive-token-file).`);
}
$('warning').textContent = warnings.join(' ');
$('warning').hidden = warnings.length === 0;
$('share').hidden = !settings.needs_token || role !== 'drive';
$('address').value = location.origin;
$('place').append(new Option(t`all places`, ''), ...known.places.map(({name}) => new Option(name, name)));
$('place').value = known.places.some(({name}) => name === wanted) ? wanted : '';

function code(job, place, text) {
  const token = $('share').hidden || !$('with-token').checked ? '' : commands.ownToken;
  const address = addressOf($('address').value.trim() || location.origin, job, place, token);
  const line = document.createElement('li');
  const picture = Object.assign(document.createElement('img'), {src: `qr.svg?text=${encodeURIComponent(address)}`, alt: address.replace(/#.*/, '')});
  line.append(picture, Object.assign(document.createElement('b'), {textContent: text}));
  return line;
}

function sheet(place) {
  const section = Object.assign(document.createElement('section'), {className: 'codes'});
  const list = document.createElement('ul');
  list.append(...Object.entries(OFFERS).map(([job, {title}]) => code(job, place, title(place))));
  section.append(Object.assign(document.createElement('h2'), {textContent: place}),
    Object.assign(document.createElement('p'), {textContent: t`Scan with your phone, then tap: the robot comes.`}), list);
  return section;
}

function show() {
  const places = $('place').value ? [$('place').value] : known.places.map(({name}) => name);
  $('sheets').replaceChildren(...places.map(sheet));
}

for (const id of ['place', 'address', 'with-token']) $(id).addEventListener('change', show);
$('print').addEventListener('click', () => print());
show();
