// page_test SOURCE FOLDER: what a visitor, a person with a keyboard and one with a screen reader meet on the page, on a phone,
// a tablet and a desktop, light and dark, with a viewer that is only pretended. Needs playwright-core and axe-core under FOLDER.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {deflateSync} from 'node:zlib';

import {PretendedViewer, hut, standing, startBrowser} from './pretended_viewer.mjs';

const [source, folder, only = ''] = process.argv.slice(2);  // only: a screen, or a screen and a theme as "phone, dark"
const places = [{name: 'lift', x: 1, y: 2, theta: 0.5}, ...Array.from({length: 27}, (_, i) => ({name: `office-${i + 1}`, x: i % 7, y: 3 + Math.floor(i / 7)}))];
const viewer = await new PretendedViewer(source, {...hut, places}).listen();
const browser = await startBrowser(folder);
const axe = readFileSync(`${folder}/node_modules/axe-core/axe.min.js`, 'utf8');
const SCREENS = {phone: {viewport: {width: 390, height: 844}, hasTouch: true, isMobile: true}, tablet: {viewport: {width: 768, height: 1024}, hasTouch: true},
  desktop: {viewport: {width: 1440, height: 900}}};

// A room of 6.4 m with a wall along its left side.
function room() {
  const bytes = new Uint8Array(2 * 64 * 64);
  for (let i = 0; i < 4096; ++i) bytes[i] = i % 64 < 2 ? 2 : 1;
  return {session: 1, revision: 1, resolution: 0.1, origin: [-1, -1], columns: 64, rows: 64, tile_column: 0, tile_row: 0,
    data: deflateSync(bytes).toString('base64')};
}
const node = (process, more = {}) => ({age: 0.2, status: {process, host: 'desk', state: 1, reason: '', cpu_fraction: 0.01, memory_bytes: 9e6,
  dropped_inputs: 0, worst_step_us: 100, ...more}});
const command = (name) => ({name, group: 'services', running: true, condition: 'ready', restarts: 0, detail: ''});
function sayProcesses() {
  viewer.say('processes', {commands: ['controller', 'planner'].map(command), order: null});
  viewer.say('nodes', {nodes: [node('controller', {reason: 'SONAR: impossible range or stamp', dropped_inputs: 3}), node('planner')], rates: {POSE: 50}, delays: {}});
}
const job = (more) => ({id: 1764184500123456, kind: 'carry', state: 'driving', priority: 0, position: 0, sender: 'a page', sentence: 'drives to lift, 3 m left',
  stop: 0, stops: ['lift', 'office-7'], waits_for: '', text: '', question: '', answers: [], ...more});
const sayJobs = (jobs, requests = []) => viewer.say('jobs', {utime: 1, jobs, requests, tours: ['morning']});
const stairs = {name: 'stairs', kind: 'keep-out', polygon: [[3, 3], [5, 3], [5, 4.5], [3, 4.5]]};
let site = {};
// What the viewer says of the building; `orders`: what became of the pages' edits.
function sayBuilding(more = {}) {
  site = {...site, orders: [], ...more};
  viewer.say('building', site);
}

const morning = {name: 'morning', at: '09:30', days: ['Mo', 'Tu', 'We', 'Th', 'Fr'],
  stops: [{place: 'lift', pause: 20, text: 'The lift is from 1931.'}, {place: 'office-7', pause: 0, text: ''}]};
const noon = {name: 'noon', days: ['Mo', 'Tu', 'We', 'Th', 'Fr', 'Sa', 'Su'], stops: [{place: 'office-3', pause: 0, text: ''}]};
let tours = {};
// What the viewer says of the stored tours.
function sayTours(more = {}) {
  tours = {...tours, orders: [], ...more};
  viewer.say('tours', tours);
}
const done = () => ({orders: [{id: viewer.edits, fate: 'done', said: '', found: []}]});

let page;
const textOf = (selector) => page.$eval(selector, (element) => element.innerText);
const says = (selector, pattern) => page.waitForFunction(([where, text]) => {
  const element = document.querySelector(where);
  return element.checkVisibility() && new RegExp(text).test(element.innerText);
}, [selector, pattern.source], {polling: 50, timeout: 40_000});
const hears = async (what, since) => {
  for (let i = 0; i < 100; ++i) {
    const found = viewer.heard.slice(since).find((request) => (what instanceof RegExp ? what.test(request) : request.startsWith(what)));
    if (found) return found;
    await page.waitForTimeout(50);
  }
  throw new Error(`the page did not ask ${what}: ${viewer.heard.slice(since)}`);
};
const stops = () => viewer.heard.filter((request) => request.startsWith('/api/stop')).length;
// A STOP that is asked for is waited for; that none is, shows within a third of a second.
const stopsBy = async (action, patience = 3000) => {
  const before = stops();
  await action();
  for (let waited = 0; waited < patience && stops() === before; waited += 50) await page.waitForTimeout(50);
  return stops() > before;
};
const stopsNotBy = async (action) => {
  // the page says a STOP again until it is obeyed: of an earlier one, on a busy machine
  for (let i = 0, last = -1; i < 10 && last !== stops(); ++i) {
    last = stops();
    await page.waitForTimeout(300);
  }
  return !await stopsBy(action, 300);
};
const bounds = (selector) => page.$eval(selector, (element) => element.getBoundingClientRect().toJSON());
const at = (x, y) => page.$eval('#map', (canvas, [u, v]) => {
  scrollTo(0, 0);  // a press further down may have moved the map out of sight
  const [centreX, centreY, scale] = canvas.dataset.view.split(' ').map(Number);
  const box = canvas.getBoundingClientRect();
  return [box.left + box.width / 2 + (u - centreX) * scale, box.top + box.height / 2 - (v - centreY) * scale];
}, [x, y]);
const isTouched = () => page.evaluate(() => matchMedia('(pointer: coarse)').matches);
const tap = async (x, y) => (await isTouched() ? page.touchscreen.tap(...await at(x, y)) : page.mouse.click(...await at(x, y)));
const drag = async (from, to) => {
  await page.mouse.move(...await at(...from));
  await page.mouse.down();
  await page.mouse.move(...await at(...to), {steps: 4});
  await page.mouse.up();
};
const colourAt = (x, y) => page.$eval('#map', (canvas, [u, v]) => {
  const [centreX, centreY, scale] = canvas.dataset.view.split(' ').map(Number);
  const dots = canvas.width / canvas.clientWidth;
  const [px, py] = [canvas.width / 2 + (u - centreX) * scale * dots, canvas.height / 2 - (v - centreY) * scale * dots];
  return String(canvas.getContext('2d').getImageData(px, py, 1, 1).data);
}, [x, y]);
const look = (title, name, theme) => page.screenshot({path: `${folder}/pictures/${title}-${name}-${theme}.png`});
const press = (selector) => page.click(selector);

const steps = {
  async 'a long sentence moves and widens nothing'(name, theme) {
    await says('#doing', /Stands still/);
    const before = await bounds('#stage');
    viewer.state.navigation = {state: 6, pose_count: 1, pose_index: 0, distance_left: 0, target: [1, 2],
      cause: `goal lies in or beside an obstacle: ${'nearest reachable point (8.3, 2.1) is 0.42 m away, tolerance 0.18 m; '.repeat(4)}`};
    await says('#doing', /Finds no way to lift/);
    await look('refused', name, theme);
    assert.deepEqual(await bounds('#stage'), before);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false, 'wider than the window');
    viewer.state = standing();
  },

  async 'two taps lead to one of 28 places'() {
    await page.fill('#place-search', 'ice-2');
    const shown = await page.$$eval('#places button', (chips) => chips.filter((chip) => chip.checkVisibility()).map((chip) => chip.textContent));
    assert.deepEqual(shown, ['office-2', ...Array.from({length: 8}, (_, i) => `office-2${i}`)]);
    const since = viewer.heard.length;
    await press('#places button:text-is("office-2")');
    assert.match(await hears('/api/goal', since), /"place":"office-2"/);
    await page.fill('#place-search', '');
  },

  async 'pause and cancel are in sight'() {
    for (const id of ['#pause', '#cancel']) {
      const [box, footer] = [await bounds(id), await bounds('footer')];
      assert(box.bottom < footer.top || box.right < footer.left, `${id} lies behind the STOP bar`);
    }
  },

  async 'the map shows what a tap means, beside the tap'(name, theme) {
    viewer.say('tile', room());
    await page.waitForFunction(() => document.querySelector('#map').dataset.tiles === '1');
    await tap(1, 2);
    await says('#ask-text', /^lift$/);
    const [box, [, py]] = [await bounds('#ask'), await at(1, 2)];
    assert(Math.min(Math.abs(box.top - py), Math.abs(box.bottom - py)) < 80, `the question lies at ${box.top}, the tap at ${py}`);
    await press('#ask-add');
    await tap(-0.8, 1);
    await press('#ask-add');
    await says('#route-stops', /lift\n.*too near a wall/);
    await look('route', name, theme);
    const since = viewer.heard.length;
    await page.check('#route-skip');
    await press('#route-go');
    assert.match(await hears('/api/goal', since), /"place":"lift".*"policy":"skip"/);
    await press('#route-clear');
  },

  async 'the map is kept as a picture'(name, theme) {
    const [file] = await Promise.all([page.waitForEvent('download'), press('#map-picture')]);
    assert.equal(file.suggestedFilename(), 'hut.png');
    const png = readFileSync(await file.path());
    assert.deepEqual([png.toString('latin1', 1, 4), png.readUInt32BE(16), png.readUInt32BE(20)], ['PNG', 128, 128], 'of 6.4 m at 20 px');
    await file.saveAs(`${folder}/pictures/map-${name}-${theme}.png`);
  },

  async 'what is frozen looks frozen'(name, theme) {
    Object.assign(viewer.state.ages, {CAMERA_IMAGE: 0.1, SONAR: 0.1});
    viewer.picture = readFileSync(`${source}/tests/data/camera_calibration/left01.jpg`);
    await page.locator('#camera-card').scrollIntoViewIfNeeded();
    const show = setInterval(() => viewer.say('picture', {sequence: 1, width: 640, height: 480, exposure_us: 900, health: '', seen: null}), 200);
    await says('#camera-caption', /no detector/);
    clearInterval(show);
    viewer.state.ages.CAMERA_IMAGE = 6.2;
    await says('#camera-caption', /picture is 6 s old/);
    assert(await page.$eval('#camera', (canvas) => canvas.classList.contains('old')));
    await says('#doing', /no picture from its camera for 6 s/);
    Object.assign(viewer.state.ages, {CAMERA_IMAGE: 0.1, CONTROL_STATUS: 8});
    await says('#doing', /controller has been silent for 8 s: the robot stands/);
    assert.match(await textOf('#facts'), /Room ahead\s+1.00 m \(8 s ago\)/);
    await look('frozen', name, theme);
    viewer.state = standing();
  },

  async 'a visitor reads words, an expert the numbers'() {
    sayProcesses();
    await says('#processes', /controller/);
    assert.match(await textOf('#facts'), /Where\s+1.0 m from lift, sure to 2 cm/);
    assert.doesNotMatch(await textOf('#side'), /innovation|impossible|Controller\n/);
    await press('#numbers');
    await says('#facts', /Controller/);
    await says('#charts', /innovation/);
    await press('#numbers');
  },

  async 'every mark on the map is named'(name, theme) {
    await press('#help-button');
    await says('#help', /Light fixtures.*lamps on the ceiling/);
    assert.equal(await page.$$eval('#legend li', (lines) => lines.length), 17);
    await look('help', name, theme);
    assert(await stopsBy(() => press('#stop')), 'the help lies over STOP');
    await page.keyboard.press('Escape');
    await page.waitForSelector('#help', {state: 'hidden'});
  },

  async 'a visitor orders in three taps, confirms and answers'(name, theme) {
    sayJobs([]);
    await page.waitForSelector('#jobs-card', {state: 'visible'});
    let since = viewer.heard.length;
    await press('#job-kinds button:text-is("Carry something")');
    await says('#job-order', /Where is it fetched/);
    await press('#job-choices button:text-is("lift")');
    await says('#job-order', /From lift: where to/);
    await page.fill('#job-search', 'office-7');
    await look('jobs-order', name, theme);
    await press('#job-choices button:text-is("office-7")');
    await hears('/api/jobs {"action":"add","kind":"carry","stops":[{"place":"lift"},{"place":"office-7"}]}', since);
    sayJobs([job({state: 'at_stop', sentence: 'is at lift and waits for "loaded"', waits_for: 'loaded'})], [{id: 7, objection: ''}]);
    since = viewer.heard.length;
    await press('#job-list button:text-is("loaded")');
    await hears('/api/jobs {"action":"confirm","job":1764184500123456,"word":"loaded"}', since);
    const question = 'on the way to office-7: the way through door 3 is blocked; waited 60 s, no other way';
    sayJobs([job({state: 'asking', stop: 1, sentence: question, question, answers: ['opened', 'give up']}),
      job({id: 5, kind: 'go', state: 'queued', position: 1, sentence: 'waits for its turn', stops: ['office-2']}),
      job({id: 4, kind: 'guide', state: 'done', position: -1, sentence: 'done, at office-3', stops: ['office-3']})]);
    await says('#job-list', /door 3 is blocked[^]*waits for its turn[^]*done, at office-3/);
    await page.locator('#jobs-card').scrollIntoViewIfNeeded();
    await look('jobs', name, theme);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false, 'wider than the window');
    viewer.files.photos = [{name: '1764184500500000-4-0'}, {name: '1764184500600000-99-0'}];
    sayJobs([job({state: 'asking', stop: 1, sentence: question, question, answers: ['opened', 'give up']}),
      job({id: 4, kind: 'guide', state: 'done', position: -1, sentence: 'done, at office-3', stops: ['office-3']})]);
    await says('#job-list', /Picture: office-3/);
    assert.deepEqual(await page.$$eval('#job-list a', (links) => links.map((link) => link.getAttribute('href'))), ['api/file?kind=photo&name=1764184500500000-4-0.jpg']);
    viewer.files.photos = [];
    since = viewer.heard.length;
    await press('#job-list button:text-is("opened")');
    await hears('/api/jobs {"action":"answer","job":1764184500123456,"word":"opened"}', since);
    const objects = setInterval(() => sayJobs([job({kind: 'guide', stops: ['office-7']})], [{id: 7, objection: '"opened" is no answer'}]), 200);
    await says('#notes', /is no answer/);
    clearInterval(objects);
    viewer.state.ages.JOB_STATUS = 9;
    await says('#jobs-word', /silent for 9 s/);
    viewer.state = standing();
    since = viewer.heard.length;
    await press('#job-list button:text-is("wait")');
    await hears('/api/jobs {"action":"confirm","job":1764184500123456,"word":"wait"}', since);
    since = viewer.heard.length;
    await press('#job-kinds button:text-is("Guide me")');
    await press('#job-choices button:text-is("lift")');
    await hears('/api/jobs {"action":"add","kind":"guide","stops":[{"place":"lift"}]}', since);
  },

  async 'a zone is drawn by taps, dragged, and saved when the check was read'(name, theme) {
    sayBuilding({version: 'a1', zones: [stairs], places: viewer.building.places, undo: null, objection: ''});
    await page.waitForSelector('#edit', {state: 'visible'});
    await press('#edit');
    await press('#fit');
    await page.waitForTimeout(200);
    assert(await page.isDisabled('#edit-undo'), 'there is nothing to undo');
    await look('edit', name, theme);
    await press('#edit-zone');
    assert(await page.isDisabled('#edit-save'));
    for (const [i, corner] of [[0, 0.2], [2, 0.2], [2, 1.2], [0, 1.2]].entries()) {
      await tap(...corner);
      await page.waitForFunction((count) => document.querySelector('#edit-corners').value.match(/[^\n]+/g)?.length === count, i + 1);
    }
    await page.fill('#edit-name', 'wet floor');
    await page.selectOption('#edit-kind', 'slow');
    await page.fill('#edit-speed', '0.15');
    await page.fill('#edit-hours', '08:00-12:00');
    await page.fill('#edit-days', 'Mo-Fr');
    await tap(2.35, 1.2);  // beside a corner a finger still taps the map
    await page.waitForFunction(() => document.querySelector('#edit-corners').value.split('\n').length === 5);
    await press('#edit-back');
    await drag([2, 1.2], [2.5, 1.5]);
    await drag([1, 0.2], [1, -0.1]);  // the middle of an edge becomes a corner
    const points = (await page.inputValue('#edit-corners')).split('\n').map((line) => line.split(' ').map(Number));
    assert.equal(points.length, 5);
    [[0, 0.2], [1, -0.1], [2, 0.2], [2.5, 1.5], [0, 1.2]].forEach((wanted, i) =>
      wanted.forEach((value, k) => assert(Math.abs(points[i][k] - value) < 0.1, `corner ${i} is ${points[i]}`)));
    await look('edit-zone', name, theme);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false, 'wider than the window');
    let since = viewer.heard.length;
    await press('#edit-save');
    const sent = JSON.parse((await hears('/api/building', since)).replace('/api/building ', ''));
    assert.deepEqual({...sent, zone: {...sent.zone, polygon: sent.zone.polygon.length}},
      {action: 'set_zone', zone: {name: 'wet floor', kind: 'slow', polygon: 5, speed: 0.15, hours: '08:00-12:00', days: 'Mo-Fr'}, version: 'a1'});
    sayBuilding({orders: [{id: viewer.edits, fate: 'asks', said: '', found: ['slow zone "wet floor" overlaps slow zone "ramp": the lower speed holds']}]});
    await says('#edit-said', /Checking the building finds:[^]*the lower speed holds/);
    await look('edit-asks', name, theme);
    since = viewer.heard.length;
    await press('#edit-save');
    assert.match(await hears('/api/building', since), /"accept":true/);
    sayBuilding({version: 'a2', zones: [stairs, sent.zone], undo: 'building-before-2026-01-31-153000.toml',
      orders: [{id: viewer.edits, fate: 'done', said: '', found: []}]});
    await says('#notes', /Saved in the building's file/);
    await says('#edit-list', /wet floor/);
    await says('#notes', /The robot goes by it/);
    const inForce = await colourAt(0.5, 0.4);
    sayBuilding({zones: [stairs, {...sent.zone, in_force: false}]});
    await page.waitForSelector('#edit-list .resting:text-is("wet floor")');
    assert.match(await page.getAttribute('#edit-list .resting', 'title'), /drive slowly, Mo-Fr 08:00-12:00/);
    for (let i = 0; i < 40 && await colourAt(0.5, 0.4) === inForce; ++i) await page.waitForTimeout(50);
    assert.notEqual(await colourAt(0.5, 0.4), inForce, 'a zone outside its hours is drawn like the others');
    await look('edit-resting', name, theme);
    await press('#edit-list .resting');
    assert.equal(await page.inputValue('#edit-hours'), '08:00-12:00');
    await press('#edit-cancel');
  },

  async 'two people who edit at once lose nothing'(name, theme) {
    await tap(4, 3.5);
    await says('#edit-form', /Delete/);
    assert.equal(await page.inputValue('#edit-name'), 'stairs');
    await page.selectOption('#edit-kind', 'one-way');
    await page.fill('#edit-heading', '90');
    viewer.refusal = {path: '/api/building', status: 409, error: 'somebody else has changed the building meanwhile: look at it, and save again'};
    sayBuilding({version: 'b1', zones: [stairs]});
    await says('#edit-hint', /Somebody else has changed/);
    await press('#edit-save');
    await says('#edit-said', /look at it, and save again/);
    assert.equal(await page.inputValue('#edit-kind'), 'one-way', 'the draft is lost');
    await look('edit-stale', name, theme);
    viewer.refusal = null;
    const since = viewer.heard.length;
    await press('#edit-save');
    assert.match(await hears('/api/building', since), /"direction":1.57.*"version":"b1","name":"stairs"/);
    sayBuilding({version: 'b2', zones: [{...stairs, kind: 'one-way', direction: 1.5708}], orders: [{id: viewer.edits, fate: 'done', said: '', found: []}]});
    await page.waitForSelector('#edit-form', {state: 'hidden'});
  },

  async 'a place is named, and the last change undone'(name, theme) {
    await press('#edit-place');
    await tap(4, 1);
    await page.fill('#edit-name', 'coffee');
    await page.fill('#edit-heading', '180');
    await look('edit-place', name, theme);
    let since = viewer.heard.length;
    await press('#edit-save');
    assert.match(await hears('/api/building', since), /"action":"set_place","place":\{"name":"coffee","x":(3.9|4),?.*"theta":3.14.*"version":"b2"/);
    sayBuilding({version: 'b3', places: [...viewer.building.places, {name: 'coffee', x: 4, y: 1}], orders: [{id: viewer.edits, fate: 'done', said: '', found: []}]});
    await says('#places', /coffee/);
    await press('#edit-undo');
    since = viewer.heard.length;
    await press('#edit-undo');
    assert.match(await hears('/api/building', since), /\{"action":"undo","version":"b3"\}/);
    sayBuilding({version: 'b4', places: viewer.building.places, orders: [{id: viewer.edits, fate: 'refused', said: 'the version before differs in more than zones and places', found: []}]});
    await says('#notes', /differs in more than zones and places/);
    await page.waitForFunction(() => !document.querySelector('#places').innerText.includes('coffee'));
    await press('#edit-close');
    await tap(1, 2);
    await says('#ask-text', /^lift$/);  // a tap is a goal again
    await press('#ask-close');
  },

  async 'a tour is written, saved when the check was read, and moved'(name, theme) {
    sayJobs([]);
    sayTours({version: 'c1', tours: [morning], undo: null, objection: ''});
    await page.waitForSelector('#tours-edit', {state: 'visible'});
    await press('#tours-edit');
    await says('#tours-list', /morning[^]*09:30 Mo–Fr · lift, office-7/);
    assert(await page.isDisabled('#tours-undo'), 'there is nothing to undo');
    await press('#tours-new');
    await says('#tours-hint', /needs a name/);
    await page.fill('#tours-name', 'evening');
    await says('#tours-hint', /needs a stop/);
    for (const [i, place] of ['lift', 'office-7', 'office-3'].entries()) {
      await press('#tours-add');
      await page.selectOption(`#tours-stops [data-tour="place ${i}"]`, place);
    }
    await page.fill('#tours-stops [data-tour="pause 0"]', '20');
    await page.fill('#tours-stops [data-tour="text 0"]', 'Good evening.');
    await page.check('#tours-stops [data-tour="photo 2"]');
    await press('#tours-stops [data-tour="stop up 2"]');
    await press('#tours-stops [data-tour="stop leave 2"]');
    await page.fill('#tours-at', '17:45');
    await says('#tours-alone', /without anybody/);
    for (const day of ['Sa', 'Su']) await press(`#tours-days [data-tour="day ${day}"]`);
    await page.locator('#tours-card').scrollIntoViewIfNeeded();
    await look('tours-form', name, theme);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false, 'wider than the window');
    let since = viewer.heard.length;
    await press('#tours-save');
    const sent = JSON.parse((await hears('/api/tours', since)).replace('/api/tours ', ''));
    assert.deepEqual(sent, {action: 'set_tour', version: 'c1', tour: {name: 'evening', at: '17:45', days: ['Mo', 'Tu', 'We', 'Th', 'Fr'],
      stops: [{place: 'lift', pause: 20, text: 'Good evening.'}, {place: 'office-3', photo: true}]}});
    sayTours({orders: [{id: viewer.edits, fate: 'asks', said: '', found: ['place "lift" at (1.00, 2.00): no way leads there']}]});
    await says('#tours-said', /Checking finds:[^]*no way leads there/);
    since = viewer.heard.length;
    await press('#tours-save');
    assert.match(await hears('/api/tours', since), /"accept":true/);
    sayTours({version: 'c2', tours: [morning, sent.tour], undo: 'jobs-before-2026-01-31-153000.toml', ...done()});
    await says('#notes', /Saved in the building's jobs file/);
    await says('#tours-list', /evening/);
    await look('tours', name, theme);
    await says('#notes', /does the process jobs run/);  // it knows morning alone
    since = viewer.heard.length;
    await press('[data-tour="down morning"]');
    assert.deepEqual(JSON.parse((await hears('/api/tours', since)).replace('/api/tours ', '')), {action: 'move_tour', name: 'morning', version: 'c2'});
    sayTours({version: 'c3', tours: [noon, morning], ...done()});
    since = viewer.heard.length;
    await press('[data-tour="up morning"]');
    assert.match(await hears('/api/tours', since), /"name":"morning","before":"noon"/);
    sayTours({version: 'c4', tours: [morning], ...done()});
    await says('#notes', /The robot goes by it/);
  },

  async 'two people who edit a tour at once lose nothing'(name, theme) {
    await press('#tours-list .name');
    await page.fill('#tours-stops [data-tour="text 1"]', 'The last office.');
    sayTours({version: 'd1', tours: [morning, noon]});
    await says('#tours-hint', /Somebody else has changed/);
    viewer.refusal = {path: '/api/tours', status: 409, error: 'somebody else has changed the tours meanwhile: look at them, and save again'};
    await press('#tours-save');
    await says('#tours-said', /look at them, and save again/);
    assert.equal(await page.inputValue('#tours-stops [data-tour="text 1"]'), 'The last office.', 'the draft is lost');
    await look('tours-stale', name, theme);
    viewer.refusal = null;
    let since = viewer.heard.length;
    await press('#tours-save');
    assert.match(await hears('/api/tours', since), /"name":"morning".*The last office.*"name":"morning".*"version":"d1"/);
    sayTours({version: 'd2', ...done()});
    await page.waitForSelector('#tours-form', {state: 'hidden'});
    await press('#tours-list .name');
    since = viewer.heard.length;
    await press('#tours-remove');
    assert.match(await hears('/api/tours', since), /"action":"remove_tour","name":"morning"/);
    sayTours({version: 'd3', tours: [noon], ...done()});
    await page.waitForSelector('#tours-form', {state: 'hidden'});
    await press('#tours-undo');
    since = viewer.heard.length;
    await press('#tours-undo');
    assert.match(await hears('/api/tours', since), /\{"action":"undo","version":"d3"\}/);
    sayTours({orders: [{id: viewer.edits, fate: 'refused', said: 'the version before differs in more than tours', found: []}]});
    await says('#notes', /differs in more than tours/);
    await press('#tours-close');
  },

  async 'recordings and maps are listed, fetched, and deleted when asked twice'(name, theme) {
    const recording = {name: 'drive-2026-01-31.lcm.00', files: ['drive-2026-01-31.lcm.00'], bytes: 1_520_000, modified: 1769850000, growing: false};
    viewer.files = {photos: [], recordings: [{...recording, name: 'drive-2026-02-01.lcm.00', growing: true}, recording],
      maps: [{name: 'map', files: ['map.yaml', 'map.pgm'], bytes: 900, modified: 1769850000, growing: false}]};
    await press('#kept summary');
    await says('#kept', /drive-2026-01-31.lcm.00\s+1.5 MB.*2026/);
    await says('#kept', /map map\s+0.9 kB/);
    assert.deepEqual(await page.$$eval('#kept a', (links) => links.map((link) => link.getAttribute('href')).slice(1)),
      ['recording&name=drive-2026-01-31.lcm.00', 'map&name=map.yaml', 'map&name=map.pgm'].map((what) => `api/file?kind=${what}`));
    await page.locator('#kept').scrollIntoViewIfNeeded();
    await look('kept', name, theme);
    const since = viewer.heard.length;
    assert(await page.isDisabled('#kept li:nth-child(1) button'), 'one that is being written can be deleted');
    await press('#kept li:nth-child(2) button');
    await says('#kept li:nth-child(2)', /Really/);
    assert(!viewer.heard.slice(since).some((request) => request.includes('delete')));
    viewer.files.recordings.pop();
    await press('#kept li:nth-child(2) button');
    await hears('/api/files {"action":"delete","kind":"recording","name":"drive-2026-01-31.lcm.00"}', since);
    await page.waitForFunction(() => document.querySelectorAll('#kept li').length === 2);
    await press('#kept summary');
  },

  async 'it speaks German where that is wished'(name, theme) {
    await press('#language-button');
    await says('#goal-actions', /Ziel abbrechen/);
    await says('#doing', /^Steht still und wartet auf ein Ziel/);
    await says('#facts', /Batterie/);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false, 'wider than the window');
    await look('german', name, theme);
    await press('#help-button');
    await says('#help', /Leuchten.*Leuchten an der Decke/);
    await look('german-help', name, theme);
    await page.keyboard.press('Escape');
    await page.waitForSelector('#help', {state: 'hidden'});
    await press('#language-button');
    await says('#goal-actions', /Cancel goal/);
    await says('#pose-state', /TRACKING/);  // the page, loaded anew, hears the robot
  },

  async 'forgetting asks first'() {
    const since = viewer.heard.length;
    await press('#clear-map');
    await says('#clear-map', /Really/);
    assert(!viewer.heard.slice(since).some((request) => request.startsWith('/api/map')));
    await press('#clear-map');
    await hears('/api/map {"action":"clear_evidence"}', since);
  },

  async 'what happened is kept over a reload'(name, theme) {
    viewer.state.navigation = {...standing().navigation, state: 3, target: [1, 2]};
    await says('#happened', /sets out to lift/);
    viewer.state.navigation.state = 5;
    await says('#happened', /arrived at lift/);
    Object.assign(viewer.state.robot, {stop_engaged: true, reason: 'viewer@desk'});
    await says('#happened', /STOP: viewer@desk/);
    viewer.state = standing();
    await says('#happened', /STOP is released/);
    await page.reload();
    await says('#happened', /STOP is released\n[^]*arrived at lift/);
    const [file] = await Promise.all([page.waitForEvent('download'), press('#happened-save')]);
    assert.match(readFileSync(await file.path(), 'utf8'), /T.*Z arrived at lift\n/);
    await look('happened', name, theme);
  },

  async 'STOP comes first on the keyboard, and the rest is reached with it'(name) {
    if (name === 'phone') return;
    const {keyboard} = page;
    await press('#layers-button');
    await page.focus('#layers input');
    const isOn = () => page.$eval('#layers input', (box) => box.checked);
    const before = await isOn();
    assert(await stopsNotBy(() => keyboard.press('Space')), 'a box that is toggled stops the robot');
    assert.equal(await isOn(), !before);
    assert(await stopsBy(() => keyboard.press('x')), 'X stops whatever has the focus');
    await page.click('#layers input');
    assert(await stopsBy(() => keyboard.press('Space')), 'a box that was clicked keeps the space bar');
    await page.focus('#pause');
    assert(await stopsBy(() => keyboard.press('Space')), 'a button keeps the space bar');
    await page.fill('#place-search', '');
    assert(await stopsNotBy(() => page.type('#place-search', 'x y')), 'writing stops the robot');
    await press('#layers-button');

    await page.focus('#map');
    const view = () => page.$eval('#map', (canvas) => canvas.dataset.view.split(' ').map(Number));
    const [x, y, scale] = await view();
    await keyboard.press('ArrowRight');
    await keyboard.press('ArrowUp');
    await keyboard.press('+');
    await page.waitForTimeout(200);
    const [newX, newY, newScale] = await view();
    assert(newX > x && newY > y && newScale > scale, 'the map does not follow the keys');
    await keyboard.press('Enter');
    await says('#ask', /Go there/);
    const since = viewer.heard.length;
    await page.focus('#ask-left');
    await keyboard.press('Enter');
    await page.focus('#ask-go');
    await keyboard.press('Enter');
    assert.match(await hears('/api/goal', since), /"theta":0.26/);
  },

  async 'the focus survives what is renewed'(name) {
    sayProcesses();
    await page.waitForSelector('button[data-process=planner]');
    await page.focus('button[data-process=planner]');
    for (let i = 0; i < 3; ++i) sayProcesses();
    await page.waitForTimeout(200);
    assert.equal(await page.evaluate(() => document.activeElement.dataset.process), 'planner', name);
  },

  async 'axe finds nothing'(name, theme) {
    sayJobs([job({state: 'asking', sentence: 'the door is shut', question: 'the door is shut', answers: ['opened', 'give up']}), job({id: 4, state: 'done', position: -1})]);
    await page.waitForSelector('#jobs-card', {state: 'visible'});
    await press('#job-kinds button');
    sayBuilding();
    sayTours({version: 'e1', tours: [morning, noon]});
    await page.waitForSelector('#edit', {state: 'visible'});
    await page.evaluate(axe);
    // on a busy machine the viewer may have been silent for a moment, and what is old is pale
    const findings = () => page.evaluate(async () => {
      const {violations} = await globalThis.axe.run();
      return document.body.classList.contains('stale') ? null
        : violations.map(({id, nodes}) => `${id}: ${nodes.map((element) => element.html.slice(0, 120)).join(' | ')}`);
    });
    for (const open of ['', '#edit', '#edit-zone', '#tours-edit', '#tours-list .name', '#layers-button', '#help-button']) {
      if (open) await press(open);
      let found = null;
      while (!found) {
        await page.waitForFunction(() => !document.body.classList.contains('stale'));
        found = await findings();
      }
      assert.deepEqual(found, [], `${name}, ${theme}, ${open}`);
    }
  },

  async 'a scanned code offers its job, and moves nothing before the tap'(name, theme) {
    const scan = async (query) => {
      await page.goto(`${viewer.address.split('#')[0]}?${query}#token=0123456789abcdef`);
      await page.waitForSelector('#offer', {state: 'visible'});
      await says('#doing', /Stands still/);
    };
    const orders = (since) => viewer.heard.slice(since).filter((request) => request.startsWith('/api/jobs'));
    let since = viewer.heard.length;
    await scan('job=guide&place=lift');
    await says('#offer-choices', /Guide me to lift/);
    await look('offer-guide', name, theme);
    const [box, footer] = [await bounds('#offer-choices button'), await bounds('footer')];
    assert(box.bottom < footer.top || box.right < footer.left, 'the offer lies behind the STOP bar');
    assert.deepEqual(orders(since), [], 'opening the address orders');
    await press('#offer-choices button');
    await hears('/api/jobs {"action":"add","kind":"guide","stops":[{"place":"lift"}]}', since);
    await page.waitForSelector('#offer', {state: 'hidden'});
    assert.doesNotMatch(page.url(), /job=/, 'a reload would offer it again');

    since = viewer.heard.length;
    await scan('job=load&place=lift');
    await says('#offer-text', /Where shall it bring it/);
    await look('offer-load', name, theme);
    await press('#offer-choices button:text-is("office-7")');
    await hears('/api/jobs {"action":"add","kind":"carry","stops":[{"place":"lift"},{"place":"office-7"}]}', since);

    since = viewer.heard.length;
    await scan('job=unload&place=office-7');
    await says('#offer-text', /Where is it fetched/);
    sayJobs([job({state: 'at_stop', stop: 1, waits_for: 'unloaded', sentence: 'is at office-7 and waits for "unloaded"'})]);
    await says('#offer-text', /is here and waits for you/);
    await press('#offer-choices button:text-is("It is unloaded")');
    await hears('/api/jobs {"action":"confirm","job":1764184500123456,"word":"unloaded"}', since);

    await scan('job=guide&place=attic');
    await says('#offer-text', /no place of that name/);
    assert.equal(await page.$$eval('#offer-choices button', (buttons) => buttons.length), 0);
    viewer.mayCommand = false;
    await scan('job=guide&place=lift');
    await says('#offer-text', /holds no token/);
    viewer.mayCommand = true;
    await press('#offer-close');
    await page.waitForSelector('#offer', {state: 'hidden'});
    sayJobs([]);
  },

  async 'codes are printed without a token unless somebody says so'(name, theme) {
    let since = viewer.heard.length;
    await page.locator('a[href="print.html"]').click();
    await says('#warning', /may administer and is not printed/);
    assert(await page.isHidden('#share'));
    await page.selectOption('#place', 'lift');
    await page.fill('#address', 'http://robot:8080/');
    await page.keyboard.press('Tab');
    await hears('/qr.svg http://robot:8080/?job=guide&place=lift', since);
    await says('#sheets', /lift[^]*Guide me to lift[^]*Load here: lift[^]*Unload here: lift/);
    assert.doesNotMatch(viewer.heard.slice(since).join(), /qr.svg[^,]*token/);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false, 'wider than the window');
    await page.evaluate(axe);
    assert.deepEqual(await page.evaluate(() => globalThis.axe.run().then(({violations}) => violations.map(({id}) => id))), []);
    viewer.role = 'drive';
    await page.goto(page.url().replace(/print.html.*/, 'print.html?place=office-7'));
    since = viewer.heard.length;
    await page.check('#with-token');
    await hears(/^\/qr.svg http:\/\/127.0.0.1.*job=(guide|load|unload)&place=office-7#token=0123456789abcdef$/, since);
    await look('print', name, theme);
    if (name === 'desktop') {
      await page.emulateMedia({media: 'print'});
      assert(await page.isHidden('#settings'), 'the settings are printed');
      await page.setViewportSize({width: 720, height: 1000});
      await look('print-paper', name, theme);
      await page.emulateMedia({media: null});
      await page.setViewportSize(SCREENS.desktop.viewport);
    }
    viewer.role = 'administer';
    await page.goto(viewer.address);
    await says('#doing', /Stands still/);
  },
};

let failure = null;
try {
  for (const [name, screen] of Object.entries(SCREENS)) {
    for (const theme of ['light', 'dark']) {
      if (!`${name}, ${theme}`.startsWith(only)) continue;
      viewer.state = standing();
      page = await (await browser.newContext({...screen, colorScheme: theme, acceptDownloads: true})).newPage();
      page.setDefaultTimeout(60_000);
      page.on('pageerror', (error) => { failure ??= error; });
      await page.goto(viewer.address);
      for (const [title, step] of Object.entries(steps)) {
        await step(name, theme).catch((error) => { error.message = `${name}, ${theme}: ${title}: ${error.message}`; throw error; });
      }
      await page.context().close();
      console.log(`ok  ${name}, ${theme}`);
    }
  }
} catch (error) {
  failure = error;
  await look('failed-page', '', '').catch(() => {});
}
console.log(failure ? `FAILED: ${failure.stack}` : 'passed');
await browser.close();
viewer.close();
process.exit(failure ? 1 : 0);
