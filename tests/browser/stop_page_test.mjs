// stop_page_test SOURCE FOLDER: what the page says of STOP and of values that make no sense, in Chromium, with a viewer
// that is only pretended. Needs playwright-core under FOLDER; pictures stay there.
import assert from 'node:assert/strict';

import {PretendedViewer, standing, startBrowser} from './pretended_viewer.mjs';

const [source, folder] = process.argv.slice(2);
const viewer = await new PretendedViewer(source).listen();
const browser = await startBrowser(folder);
const open = async (options) => {
  const page = await (await browser.newContext(options)).newPage();
  page.on('pageerror', (error) => { throw error; });
  await page.goto(viewer.address);
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
      [selector, pattern.source], {polling: 50, timeout: 90_000});
  }
};
const hides = async (selector) => {
  for (const page of Object.values(pages)) await page.waitForSelector(selector, {state: 'hidden', timeout: 90_000});
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
  viewer.close();
}
process.exit(failure ? 1 : 0);
