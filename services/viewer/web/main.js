import {time} from './charts.js';
import * as commands from './commands.js';
import {Connection} from './connection.js';
import {Theme} from './colours.js';
import {Editor} from './editor.js';
import {Ground} from './ground.js';
import {guarded, whatIsBroken} from './guard.js';
import {Goals} from './goals.js';
import {Happenings} from './happenings.js';
import {Jobs} from './jobs.js';
import {Kept} from './kept.js';
import {drawCrosshair, listenForStop, listenOnMap} from './keyboard.js';
import * as draw from './layers.js';
import {MEANINGS, explain, mark} from './legend.js';
import {download, mapPicture} from './map_picture.js';
import {MapView} from './map_view.js';
import {NAVIGATION, nameOf} from './names.js';
import {Offer} from './offer.js';
import {Panels, note} from './panels.js';
import {Particles} from './particles.js';
import {Playback} from './playback.js';
import {Picture} from './picture.js';
import {Processes} from './processes.js';
import {Steering} from './steering.js';
import {Stop} from './stop.js';
import {Survey} from './survey.js';
import {speak, t, translated} from './texts.js';
import {Tiles} from './tiles.js';
import {Tours} from './tours.js';
import {Trails} from './trails.js';

speak(document.getElementById('language-button'));
const $ = (id) => document.getElementById(id);
const STALE_S = 1.0;   // [s] then what is drawn is not what is
const TILES_MS = 150;
const KNOB_PX = 44;

const theme = new Theme($('theme-button'));
const view = new MapView($('map'));
const panels = new Panels();
const picture = new Picture($('camera'), $('camera-caption'), $('camera-none'));
const connection = new Connection();
const happenings = new Happenings({list: $('happened'), save: $('happened-save'), clear: $('happened-clear')});
const processes = new Processes(ask, (subject, text, tone, seconds) => {
  note(subject, text, tone, seconds);
  happenings.add(text, tone);
});
const steering = new Steering({stick: $('stick'), knob: $('knob'), keysButton: $('keys'), word: $('hand-word')}, connection);

new Kept({details: $('kept'), list: $('kept').querySelector('ul')}, ask);
$('kept').querySelector('ul').dataset.empty = t`nothing yet`;
const jobs = new Jobs(ask, note);
const survey = new Survey(ask);
const tours = new Tours({note, known: () => jobs.tours});
const stop = new Stop(ask, (number) => nameOf(NAVIGATION, number));

const offer = new Offer({send: (body) => jobs.send(body), jobs: () => jobs.queue, mayCommand: () => stop.mayCommand});

let building = null;
let site = null;  // zones and places, as they are now
let state = null;
let path = null;
let cloud = null;
let hypotheses = [];
let isFollowing = false;
let isFitted = false;
let isMoved = false;  // by a person
const trails = new Trails();
const particles = new Particles();
const layers = Object.fromEntries(draw.LAYERS.map(([key, , isOn]) => [key, isOn]));

let isDirty = true;
const redraw = () => { isDirty = true; };
const redrawAll = () => { ground.change(); redraw(); };
let tilesShown = 0;  // timer: a map that is being loaded is not painted anew with each tile
const tiles = new Tiles((isNew) => {
  if (isNew && !isFitted) fit();
  tilesShown ||= setTimeout(() => { tilesShown = 0; redrawAll(); }, TILES_MS);
});

function fit() {
  const box = survey.bounds() ?? tiles.bounds() ?? boundsOf(building);
  if (box) { view.fit(box); isFitted = true; }
}

function boundsOf(known) {
  const points = known ? [...known.fixtures.map((f) => f.pose), ...known.places.map((p) => [p.x, p.y])] : [];
  if (points.length < 2) return null;
  const xs = points.map((p) => p[0]);
  const ys = points.map((p) => p[1]);
  return [Math.min(...xs) - 2, Math.min(...ys) - 2, Math.max(...xs) + 2, Math.max(...ys) + 2];
}

// ---- what comes in

commands.settings.then(() => fetch('building.json')).then((answer) => answer.json()).then((known) => {
  building = known;
  steering.limits = {linear: known.robot.maximum_linear, angular: known.robot.maximum_angular};
  $('building').textContent = known.name;
  document.title = `Luminav · ${known.name}`;
  showPlaces(known.places);
  takeSite();
  if (!isFitted) fit();
  redrawAll();
});

function showPlaces(places) {
  goals.setPlaces(places);
  jobs.setPlaces(places);
  tours.setPlaces(places);
  offer.setPlaces(places);
}

// Somebody may have changed zones and places since.
function takeSite() {
  if (!building || !site) return;
  const isOld = JSON.stringify(building.places) !== JSON.stringify(site.places);
  Object.assign(building, {zones: site.zones, places: site.places});
  if (isOld) showPlaces(site.places);
  editor.show(site);
  redraw();
}

connection.addEventListener('state', ({detail}) => {
  state = detail;
  const {ages} = state;
  stop.show(state);
  guarded(t`what happened`, () => happenings.watch(state, building));
  picture.watch(ages);
  guarded(t`the trail`, () => trails.extend(state, STALE_S));
  watchSurvey();
  const here = whereabouts();
  if (isFollowing && here) view.centre = here;
  panels.show(state, building, survey.isOn);
  jobs.watch(ages);
  offer.render();
  guarded(t`what became of requests`, () => showRequests(state.requests));
  redraw();
});
connection.addEventListener('nodes', ({detail}) => {
  guarded(t`the processes`, () => processes.showNodes(detail));
  guarded(t`the delays`, () => panels.showDelays(detail));
  guarded(t`the charts`, () => panels.drawCharts(theme.colours));
  tiles.dropOld();
});
connection.addEventListener('processes', ({detail}) => guarded(t`the processes`, () => {
  processes.showCommands(detail);
  happenings.watchProcesses(detail);
}));
connection.addEventListener('path', ({detail}) => { path = detail; redraw(); });
connection.addEventListener('jobs', ({detail}) => guarded(t`the jobs`, () => { jobs.show(detail); offer.render(); }));
connection.addEventListener('survey', ({detail}) => guarded(t`the survey`, () => { survey.show(detail); redraw(); }));
connection.addEventListener('tours', ({detail}) => guarded(t`the tours`, () => tours.show(detail)));
connection.addEventListener('building', ({detail}) => guarded(t`the building`, () => { site = detail; takeSite(); }));
connection.addEventListener('tile', ({detail}) => guarded(t`the map`, () => tiles.take(detail)));
connection.addEventListener('picture', ({detail}) => guarded(t`the camera`, () => picture.show(detail)));
connection.addEventListener('hypotheses', ({detail}) => guarded(t`the particles`, () => takeHypotheses(detail)));
function takeHypotheses(detail) {
  hypotheses = detail.hypotheses;
  const bytes = new DataView(Uint8Array.from(atob(detail.particles), (letter) => letter.charCodeAt(0)).buffer);
  const count = Math.min(detail.particle_count, Math.floor(bytes.byteLength / 6));
  cloud = {count, x: new Float32Array(count), y: new Float32Array(count), theta: new Float32Array(count),
    weight: new Float32Array(count)};
  for (let i = 0; i < count; ++i) {
    cloud.x[i] = detail.origin[0] + bytes.getInt16(6 * i, true) / 100;
    cloud.y[i] = detail.origin[1] + bytes.getInt16(6 * i + 2, true) / 100;
    cloud.theta[i] = bytes.getInt8(6 * i + 4) * 2 * Math.PI / 256;
    cloud.weight[i] = bytes.getUint8(6 * i + 5) / 255;
  }
  redraw();
}

// Where the robot is on the map that is shown; null where that is not known.
function whereabouts() {
  if (survey.isOn) return survey.pose()?.slice(0, 2) ?? null;
  const {pose, ages} = state;
  return Number.isFinite(pose?.x) && Number.isFinite(pose?.y) && ages.POSE < STALE_S ? [pose.x, pose.y] : null;
}

// A survey's map grows: until somebody moves it, all of it is shown.
function watchSurvey() {
  const wasOn = survey.isOn;
  guarded(t`the survey`, () => survey.watch(state));
  if (survey.isOn !== wasOn) { isMoved = false; redrawAll(); }
  if (survey.isOn !== wasOn || (survey.isOn && !isMoved && !isFollowing)) fit();
}

// Nothing frozen may look alive.
connection.addEventListener('watch', () => {
  const stale = $('stale');
  let text = '';
  if (connection.isSilent()) {
    text = Number.isFinite(connection.silence())
      ? t`No word from the viewer for ${Math.round(connection.silence())} s: this picture is old. Trying to reach it …`
      : t`Reaching for the viewer …`;
  } else if (playback.isOn) {
    text = whatIsBroken();
  } else if (state && Object.keys(state.ages).every((channel) => channel === 'NODE_STATUS')) {  // that is the viewer's own
    text = t`The viewer runs, but hears nothing of a robot: is the system started?`;
  } else if (state?.robot && state.ages.ROBOT_STATUS > STALE_S) {
    text = t`The robot's driver has been silent for ${Math.round(state.ages.ROBOT_STATUS)} s: this picture is old.`;
  } else if (state?.pose && state.ages.POSE > STALE_S) {
    text = t`The localizer has been silent for ${Math.round(state.ages.POSE)} s: the robot may be elsewhere.`;
  } else {
    text = whatIsBroken();
  }
  if (stale.textContent !== text) stale.textContent = text;
  stale.hidden = !text;
  document.body.classList.toggle('stale', Boolean(text) && text !== whatIsBroken());
});

// ---- a log in place of a robot

const playback = new Playback(ask, connection);
playback.addEventListener('begin', () => {
  for (const part of [stop, goals, happenings]) part.turnOff();
  time.now = () => playback.state?.position ?? 0;
  view.addEventListener('resize', fit, {once: true});  // the bar takes some of its room
});
playback.addEventListener('jump', () => {
  [state, path, cloud, hypotheses] = [null, null, null, []];
  for (const part of [trails, panels]) part.clear();
  tiles.outdate();
  redrawAll();
});

// ---- what goes out

const OWNERS = {goal: t`the planner`, stop: t`driver and controller`, motors: t`the driver`, initial_pose: t`the localizer`,
  map: t`the mapper`, survey: t`the surveyor`};
const reported = new Map();

function showRequests(requests) {
  for (const {kind, fate, id, objection, age} of requests) {
    const subject = translated(kind.replace('_', ' '));
    if (fate === 'waiting' && age > 0.6 && kind !== 'stop') note(kind, t`${subject}: waiting for ${OWNERS[kind]} …`, 'warn', 2);
    if (reported.get(kind) === id || fate === 'waiting') continue;
    reported.set(kind, id);
    if (fate === 'unanswered' && age < 20) note(kind, `${subject}: ${objection || t`no answer from ${OWNERS[kind]}`}`, 'bad');
    if (fate === 'answered' && objection && age < 20) note(kind, `${subject}: ${objection}`, 'bad');
    if (fate === 'answered' && kind === 'map' && !objection && age < 20) note(kind, t`map: done; saved maps are map.yaml and map.pgm in the mapper's state folder`, '', 6);
  }
}

async function ask(subject, send, what) {
  try {
    await send();
    note(subject, t`Asked: ${translated(subject)} ${what}`.trim(), '', 2.5);
  } catch (error) {
    const text = t`${translated(subject)} failed: ${error.message}`;
    note(subject, text, 'bad');
    happenings.add(text, 'bad');
  }
}

// already on the way down: a tap that slips is still a stop
let lastStop = 0;
$('stop').addEventListener('pointerdown', () => { lastStop = performance.now(); stop.press(); });
$('stop').addEventListener('click', () => { if (performance.now() - lastStop > 1000) stop.press(); });  // by key or reader
listenForStop((key) => { if (!playback.isOn) stop.press(); else if (key === 'Space') playback.toggle(); });

$('motors').addEventListener('click', () => ask('motors', commands.motorsOn, t`on`));
$('cancel').addEventListener('click', () => ask('cancel', () => commands.goal('cancel'), ''));
$('pause').addEventListener('click', () => {
  const action = state?.navigation?.state === 11 ? 'resume' : 'pause';
  ask(action, () => commands.goal(action), '');
});

const goals = new Goals({view, ask, note, redraw: () => redraw(), isTight: (x, y) => tiles.isOccupiedNear(x, y, halfWidth())});
const editor = new Editor({view, note, redraw: () => redraw(), turn: (isOn) => goals.giveWay(isOn)});
// [m] that must be free on each side of the middle between the wheels
function halfWidth() { return Math.max(0, ...(building?.robot.footprint.map(([, y]) => Math.abs(y)) ?? [])) + 0.04; }

// ---- the map

function follow(isOn) {
  isFollowing = isOn;
  $('follow').setAttribute('aria-pressed', String(isOn));
  const here = isOn && state && whereabouts();
  if (here) {
    view.centre = here;
    if (view.scale < 50) view.scale = 60;
  }
  redraw();
}

$('follow').addEventListener('click', () => follow(!isFollowing));
$('fit').addEventListener('click', () => { follow(false); isMoved = false; fit(); });
$('zoom-in').addEventListener('click', () => { isMoved = true; view.zoom(1.4); });
$('zoom-out').addEventListener('click', () => { isMoved = true; view.zoom(1 / 1.4); });
view.addEventListener('pan', () => { isMoved = true; follow(false); });
view.addEventListener('change', redraw);
let oldSize = [view.width, view.height];
view.addEventListener('resize', () => {
  const isRough = Math.abs(view.width - oldSize[0]) > 0.2 * oldSize[0];
  oldSize = [view.width, view.height];
  if (isRough && !isFollowing) fit();
});
theme.addEventListener('change', () => { tiles.setColours(theme.colours.tiles); colourLegend(); redrawAll(); });
listenOnMap(view, {choose: (x, y) => { if (editor.isOn) editor.tap(x, y); else goals.tap(x, y); if (goals.draft) $('ask-go').focus(); }, fit: () => $('fit').click(),
  isSteering: () => $('keys').getAttribute('aria-pressed') === 'true'});
tiles.setColours(theme.colours.tiles);

$('happened').dataset.empty = t`nothing yet`;
const swatches = [];
for (const [key, label] of draw.LAYERS) {
  const box = Object.assign(document.createElement('input'), {type: 'checkbox', checked: layers[key]});
  box.addEventListener('change', () => { layers[key] = box.checked; redrawAll(); });
  const line = document.createElement('label');
  const swatch = document.createElement('span');
  swatches.push([swatch, key]);
  line.append(box, swatch, translated(label));
  line.title = translated(MEANINGS[key][2]);
  $('layers').append(line);
}
function colourLegend() {
  for (const [swatch, key] of swatches) swatch.replaceChildren(mark(key, theme.colours));
  explain($('legend'), draw.LAYERS, theme.colours);
}
colourLegend();
// Not modal: nothing may lie over STOP.
$('help-button').addEventListener('click', () => ($('help').open ? $('help').close() : $('help').show()));
addEventListener('keydown', (event) => { if (event.key === 'Escape') $('help').close(); });
$('layers-button').addEventListener('click', () => {
  $('layers').hidden = !$('layers').hidden;
  $('layers-button').setAttribute('aria-expanded', String(!$('layers').hidden));
});

$('map-picture').addEventListener('click', () => {
  if (!tiles.geometry) { note('map', t`There is no map yet.`, 'warn'); return; }
  mapPicture(tiles, building, theme.colours).toBlob((blob) => {
    const name = `${building?.name ?? 'map'}.png`;
    download(blob, name);
    note('map', t`The map is in ${name} (${(blob.size / 1e3).toFixed(0)} kB), where your browser puts what it downloads.`);
  });
});

function drawScale() {
  const wanted = 110 / view.scale;
  const decade = 10 ** Math.floor(Math.log10(wanted));
  const length = [5, 2, 1].map((n) => n * decade).find((n) => n <= wanted) ?? decade;
  $('scale-bar').style.width = `${length * view.scale}px`;
  $('scale-text').textContent = length >= 1 ? `${length} m` : `${Math.round(length * 100)} cm`;
}

const ground = new Ground(view, (context, window) => {
  context.fillStyle = theme.colours.outside;
  context.fillRect(0, 0, window.width, window.height);
  tiles.draw(context, window, layers);
  if (survey.isOn) return;  // another world than the building's
  if (building && layers.ceiling) draw.drawCeiling(context, window, building, theme.colours);
  if (building && layers.fixtures) draw.drawFixtures(context, window, building, theme.colours);
});

function paint() {
  const {context} = view;
  const {colours} = theme;
  ground.draw();
  drawScale();
  // for whoever looks from outside
  Object.assign(view.canvas.dataset, {view: `${view.centre[0]} ${view.centre[1]} ${view.scale}`, tiles: tiles.shown.size});
  if (!building) return;
  if (survey.isOn) { paintSurvey(); return; }
  const pose = state?.pose && [state.pose.x, state.pose.y, state.pose.theta];
  const isTracking = state?.pose?.state === 2;
  const seen = (state?.ages.FIXTURE_DETECTIONS < STALE_S && isTracking && state.detections?.detections.filter((d) => d.world)) || [];
  if (layers.fixtures) draw.drawSeenFixtures(context, view, building, seen, colours);
  if (layers.detections) draw.drawDetections(context, view, seen, colours);
  if (layers.odometry) draw.drawTrail(context, view, trails.odometry, colours.odometryTrail, [6, 3]);
  if (layers.trail) draw.drawTrail(context, view, trails.pose, colours.trail);
  if (layers.truth) draw.drawTrail(context, view, trails.truth, colours.truthTrail, [3, 4]);
  if (layers.zones) draw.drawZones(context, view, building, colours);
  if (layers.places) draw.drawPlaces(context, view, building, colours);
  if (layers.particles && cloud && !isTracking) particles.draw(context, view, cloud, colours.particle);
  if (layers.path) draw.drawPath(context, view, path, state?.navigation, state?.control, colours);
  if (state?.truth && layers.people) draw.drawPeople(context, view, state.truth.people, colours);
  if (layers.hypotheses && !isTracking) draw.drawHypotheses(context, view, hypotheses, colours);
  if (state?.truth && layers.truth) {
    const {x, y, theta} = state.truth;
    draw.drawRobot(context, view, [x, y, theta], building.robot, colours.truth, colours.halo, false);
  }
  if (pose && isTracking) {
    if (state.sonar && layers.sonar && state.ages.SONAR < STALE_S) {
      draw.drawSonar(context, view, pose, state.sonar, building.robot, colours);
    }
    draw.drawCovariance(context, view, pose, state.pose.covariance, colours.tracking);
    draw.drawRobot(context, view, pose, building.robot, colours.tracking, colours.halo, true);
    if (state.control && layers.forces) draw.drawForces(context, view, pose, state.control, colours);
  }
  paintOrders();
}

// The survey's world is not the building's: nothing else has a place in it.
function paintSurvey() {
  const {context} = view;
  const {colours} = theme;
  view.handle = null;
  if (layers.survey) survey.draw(context, view, colours);
  if (layers.path && survey.map.exploring) draw.drawPath(context, view, path, state?.navigation, state?.control, colours);
  const pose = survey.pose();
  if (!pose) return;
  if (state.sonar && layers.sonar && state.ages.SONAR < STALE_S) draw.drawSonar(context, view, pose, state.sonar, building.robot, colours);
  draw.drawRobot(context, view, pose, building.robot, colours.tracking, colours.halo, true);
}

// What a person is about to ask for.
function paintOrders() {
  const {context} = view;
  const {colours} = theme;
  goals.route.forEach((stop) => draw.drawGoal(context, view, [stop.x, stop.y, stop.theta],
    goals.isTight(stop.x, stop.y) ? colours.lost : colours.draft));
  editor.draw(context, colours);
  drawCrosshair(context, view, colours.draft);
  const {draft} = goals;
  view.handle = null;
  if (draft) {
    draw.drawGoal(context, view, [draft.x, draft.y, draft.theta], colours.draft, KNOB_PX);
    const [px, py] = view.toScreen(draft.x, draft.y);
    const heading = draft.theta ?? 0;
    view.handle = {x: px + KNOB_PX * Math.cos(heading), y: py - KNOB_PX * Math.sin(heading)};
  }
}

(function frame() {
  requestAnimationFrame(frame);
  if (isDirty) { isDirty = false; guarded(t`the map`, paint); }
})();
