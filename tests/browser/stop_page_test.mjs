// stop_page_test SOURCE FOLDER: what the page says of STOP and of values that make no sense, in Chromium, with a viewer
// that is only pretended. Needs playwright-core under FOLDER; pictures stay there.
import assert from 'node:assert/strict';
import {existsSync, mkdirSync, readdirSync, readFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {userInfo} from 'node:os';

const [source, folder] = process.argv.slice(2);
const web = `${source}/services/viewer/web`;
const types = {html: 'text/html', css: 'text/css', js: 'text/javascript', svg: 'image/svg+xml'};

const building = {name: 'hut', fixtures: [], elements: [], doors: [], windows: [], places: [{name: 'lift', x: 1, y: 2}],
  robot: {maximum_linear: 0.5, maximum_angular: 1, footprint: [[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.2, -0.2]],
    sonar: {discs: [], opening_angle: 0.3, maximum_range: 3}}};
const standing = () => ({
  utime: 1e15, ages: {POSE: 0.02, ROBOT_STATUS: 0.02, CONTROL_STATUS: 0.02, NAVIGATION_STATUS: 0.1}, requests: [],
  pose: {state: 2, x: 1, y: 1, theta: 0, covariance: [1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1e-4], reason: '', nis: 1, distance_since_fixture: 0.3},
  robot: {connected: true, motors_enabled: true, stop_engaged: false, stop_button: false, battery_voltage: 12.5, linear: 0, angular: 0, reason: ''},
  control: {state: 0, reason: '', linear: 0, angular: 0, clearance: 1, stop_engaged: false},
  navigation: {state: 0, pose_count: 0, pose_index: 0, distance_left: 0, cause: ''}});
const viewer = {state: standing(), answers: true, mayCommand: true, stops: 0, heard: []};

const server = createServer((request, response) => {
  const path = request.url === '/' ? '/index.html' : request.url.split('?')[0];
  if (path === '/events') {
    response.writeHead(200, {'Content-Type': 'text/event-stream'});
    const timer = setInterval(() => response.write(`event: state\ndata: ${JSON.stringify(viewer.state)}\n\n`), 50);
    request.on('close', () => clearInterval(timer));
  } else if (path.startsWith('/api/')) {
    if (!viewer.answers) return;  // as one that is frozen
    let body = '';
    request.on('data', (piece) => { body += piece; });
    request.on('end', () => {
      viewer.heard.push(`${path} ${body}`);
      response.end(path === '/api/watch' ? JSON.stringify({may_command: viewer.mayCommand}) : '{"id":7}');
    });
  } else if (path === '/building.json') response.end(JSON.stringify(building));
  else if (path === '/settings.json') response.end(JSON.stringify({command_port: server.address().port, needs_token: true}));
  else if (readdirSync(web).includes(path.slice(1))) {
    response.writeHead(200, {'Content-Type': types[path.split('.').at(-1)]});
    response.end(readFileSync(web + path));
  } else {
    response.writeHead(404);
    response.end();
  }
});
await new Promise((listening) => server.listen(0, '127.0.0.1', listening));

const executablePath = process.env.LUMINAV_CHROMIUM ?? '/usr/bin/chromium';
if (!existsSync(executablePath)) {
  console.log(`skipped: no ${executablePath}`);
  process.exit(77);
}
mkdirSync(`${folder}/pictures`, {recursive: true});
const {chromium} = createRequire(`${folder}/`)('playwright-core');
const browser = await chromium.launch({executablePath, args: userInfo().uid === 0 ? ['--no-sandbox'] : []});
const open = async (options) => {
  const page = await (await browser.newContext(options)).newPage();
  page.on('pageerror', (error) => { throw error; });
  await page.goto(`http://127.0.0.1:${server.address().port}/#token=0123456789abcdef`);
  return page;
};
const pages = {
  desktop: await open({viewport: {width: 1440, height: 900}, colorScheme: 'light'}),
  phone: await open({viewport: {width: 390, height: 844}, hasTouch: true, isMobile: true, colorScheme: 'dark'})};
const says = async (selector, pattern) => {
  for (const page of Object.values(pages)) {
    await page.waitForFunction(([where, text]) => {
      const element = document.querySelector(where);
      return element.checkVisibility() && new RegExp(text).test(element.innerText);
    },
      [selector, pattern.source], {polling: 50, timeout: 20_000});
  }
};
const hides = async (selector) => {
  for (const page of Object.values(pages)) await page.waitForSelector(selector, {state: 'hidden', timeout: 20_000});
};
const look = async (title) => {
  for (const [name, page] of Object.entries(pages)) await page.screenshot({path: `${folder}/pictures/${title}-${name}.png`});
};
const press = (selector) => pages.phone.tap(selector);

async function useThePages() {
  await says('#building', /hut/);
  await says('#doing', /Stands still/);
  await hides('#stop-banner');
  await hides('#releases');
  assert.equal(new URL(pages.desktop.url()).hash, '', 'the token stays in the address bar');

  viewer.mayCommand = false;
  await says('#no-token', /look and press STOP/);
  await look('no-token');
  viewer.mayCommand = true;
  await hides('#no-token');

  viewer.answers = false;
  await says('#stop-banner', /cannot stop the robot from here/);
  await says('#stop-state', /No way to the robot/);
  await look('unreached');
  await press('#stop');
  await pages.phone.waitForFunction(() => /Sending STOP/.test(document.querySelector('#stop-state').textContent));
  await pages.phone.waitForFunction(() => /has not got through for \d+ s.*button on the robot/.test(
    document.querySelector('#stop-banner').textContent));
  await look('not-through');
  viewer.answers = true;
  await pages.phone.waitForFunction(() => /got through after \d+ s/.test(document.querySelector('#stop-banner').textContent));
  assert(viewer.heard.some((request) => request === '/api/stop {"engaged":true}'), 'it went on trying');

  viewer.state.requests = [{kind: 'stop', fate: 'waiting', id: 7, engages: true, objection: '', age: 12}];
  await says('#stop-state', /sent, not obeyed yet/);
  await pages.desktop.waitForFunction(() => /not both obeyed/.test(document.querySelector('#stop-banner').textContent));
  await says('#release', /Release stop/);
  await look('pending');

  viewer.state.requests = [];
  Object.assign(viewer.state.robot, {stop_engaged: true, linear: 0.2});
  viewer.state.control.stop_engaged = true;
  Object.assign(viewer.state.navigation, {state: 3, target: [1, 2], pose_count: 1});
  await says('#stop-state', /Stopping/);
  viewer.state.robot.linear = 0;
  await says('#stop-state', /The robot stands/);
  await says('#release-go', /go on/);
  await look('stands');
  viewer.heard = [];
  await press('#release');
  await pages.phone.waitForFunction(() => /does not pause/.test(document.querySelector('#notes').innerText));
  assert(!viewer.heard.some((request) => request.startsWith('/api/stop')), 'a planner that does not pause would go on');
  viewer.heard = [];
  await press('#release-go');
  await pages.phone.waitForFunction(() => /release of the stop, and on/.test(document.querySelector('#notes').innerText));
  assert(viewer.heard.includes('/api/stop {"engaged":false}'));

  Object.assign(viewer.state, standing());
  await hides('#releases');
  viewer.state.control.linear = null;  // NaN has no JSON
  viewer.state.pose.x = null;
  viewer.state.ages.POSE = 0.03;
  await says('#stale', /cannot show/);
  viewer.state.robot.motors_enabled = false;
  await says('#doing', /motors are off/);
  await look('odd-values');
  Object.assign(viewer.state, standing());
  await hides('#stale');

  viewer.state = {utime: 1e15, ages: {NODE_STATUS: 0.1}, requests: []};
  await says('#stale', /hears nothing of a robot/);
}

let failure = null;
try {
  await useThePages();
  console.log('passed');
} catch (error) {
  failure = error;
  console.log(`FAILED: ${error.stack}`);
  await look('failed-stop-page').catch(() => {});
} finally {
  await browser.close();
  server.closeAllConnections();
  server.close();
}
process.exit(failure ? 1 : 0);
