// playback_test SOURCE BIN FOLDER: a recorded log on the page, on a phone, a tablet and a desktop, light and dark, in English and
// German; with the viewer itself and no robot. Needs playwright-core, axe-core and ajv under FOLDER. Pictures stay there.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {cpSync, mkdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {once} from 'node:events';
import {createRequire} from 'node:module';
import {setTimeout as sleep} from 'node:timers/promises';

import {startBrowser} from './pretended_viewer.mjs';

const [source, bin, folder, only = ''] = process.argv.slice(2);  // only: "phone, dark"
const SCREENS = {phone: {viewport: {width: 390, height: 844}, hasTouch: true, isMobile: true}, tablet: {viewport: {width: 768, height: 1024}, hasTouch: true},
  desktop: {viewport: {width: 1440, height: 900}}};
const browser = await startBrowser(folder);
const axe = readFileSync(`${folder}/node_modules/axe-core/axe.min.js`, 'utf8');

// As a person has it: the log, and beside it robot and building, under another name than the shipped one.
const kept = `${folder}/playback`;
rmSync(kept, {recursive: true, force: true});
mkdirSync(`${kept}/drive.lcm.config`, {recursive: true});
cpSync(`${source}/tests/replay/logs/kidnapped.lcm`, `${kept}/drive.lcm`);
cpSync(`${source}/launch/robots/p3dx.toml`, `${kept}/drive.lcm.config/robot.toml`);
cpSync(`${source}/launch/buildings/laboratory`, `${kept}/drive.lcm.config/building`, {recursive: true});
const building = `${kept}/drive.lcm.config/building/building.toml`;
writeFileSync(building, readFileSync(building, 'utf8').replace(/^name = .*$/m, 'name = "kept-beside"'));

function view(log, ...options) {
  const viewer = spawn(`${source}/scripts/view`, [log, '--port', '0', ...options],
    {env: {...process.env, LUMINAV_BIN: bin, LUMINAV_STATE: `${kept}/state`}, stdio: ['ignore', 'pipe', 'inherit']});
  viewer.address = new Promise((found, failed) => {
    let said = '';
    viewer.stdout.on('data', (piece) => {
      said += piece;
      const address = /open (http:\S+)/.exec(said);
      if (address) found(address[1]);
    });
    viewer.on('exit', () => failed(new Error(`the viewer ended: ${said}`)));
  });
  return viewer;
}
async function end(viewer) {
  if (viewer.exitCode === null) { viewer.kill(); await once(viewer, 'exit'); }
}

let page;
let address;
const ask = async (path) => (await fetch(address + path)).json();
const order = (body, path = 'playback') => fetch(`${address}api/${path}`,
  {method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify(body)});
const state = async () => (await ask('api/playback')).state;
const textOf = (selector) => page.$eval(selector, (element) => element.innerText);
const says = (selector, pattern) => page.waitForFunction(([where, text]) => {
  const element = document.querySelector(where);
  return element.checkVisibility() && new RegExp(text).test(element.innerText);
}, [selector, pattern.source], {polling: 50, timeout: 40_000});
const until = async (what, holds) => {
  for (let i = 0; i < 600; ++i) {
    if (await holds()) return;
    await sleep(100);
  }
  throw new Error(`${what}: not within a minute`);
};
const look = (title, name, theme) => page.screenshot({path: `${folder}/pictures/${title}-${name}-${theme}.png`});

const steps = {
  async 'it is a log that is shown, and nobody can command'() {
    await says('#playback', /drive\.lcm/);
    await says('#building', /kept-beside/);
    for (const part of ['#stop', '#go-card', '#hand-card', '#save-map', '#stop-banner', '#no-token']) assert(!await page.isVisible(part), part);
    await page.mouse.click(...await page.$eval('#map', (map) => { const box = map.getBoundingClientRect(); return [box.left + box.width / 2, box.top + 150]; }));
    assert(!await page.isVisible('#ask'), 'a tap asks for a goal');
    for (const path of ['stop', 'goal', 'watch']) assert.equal((await order({}, path)).status, 403, path);
  },

  async 'it plays, at the speed that is asked for, and pauses'() {
    await order({position: 0, playing: false, speed: 1});
    await until('stands at the beginning', async () => (await state()).position === 0);
    await page.selectOption('#speed', '16');
    await page.click('#play');
    await until('plays', async () => (await state()).position > 16);
    assert.equal((await state()).speed, 16);
    await page.keyboard.press('Space');
    await until('pauses', async () => !(await state()).playing);
    const {position} = await state();
    await sleep(300);
    assert.equal((await state()).position, position, 'a log that is paused goes on');
    await says('#facts', /Where/);
    await page.waitForFunction(() => Number(document.querySelector('#map').dataset.tiles) > 5);
  },

  async 'its marks lead to the loss, the slider and the keys anywhere'(name, theme) {
    await says('#happened', /does not know where it is any more/);
    const {marks} = await ask('api/playback');
    const lost = marks.find(({kind}) => kind === 'lost');
    assert.equal(await page.$$eval('#marks i', (ticks) => ticks.length), marks.length);
    await page.locator('#happened li', {hasText: 'does not know'}).first().locator('button').click();
    await says('#pose-state', /LOST|AMBIGUOUS/);
    assert(Math.abs((await state()).position - lost.at) < 0.01);
    await page.evaluate(() => scrollTo(0, 0));
    await look('playback-lost', name, theme);
    const slider = page.locator('#position');
    await slider.fill(String(Number((lost.at - 2).toFixed(1))));
    await says('#pose-state', /TRACKING/);
    await until('jumped back', async () => Math.abs((await state()).position - lost.at + 2) < 0.2);
    await sleep(500);
    const before = (await state()).position;
    await slider.press('ArrowRight');
    await until('five seconds on', async () => Math.abs((await state()).position - before - 5) < 0.2);
  },

  async 'at the end it stops, and plays once more'() {
    await order({position: 1e6, playing: true});
    await until('stops', async () => !(await state()).playing);
    await says('#time', /0:57 \/ 0:57/);
    await page.click('#play');
    await until('from the beginning', async () => { const {position, playing} = await state(); return playing && position < 40; });
    await order({playing: false, position: 30});
  },

  async 'it fits the screen, and axe finds nothing'(name, theme) {
    await page.evaluate(() => scrollTo(0, 0));
    await says('#pose-state', /TRACKING/);
    await look('playback', name, theme);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false, 'wider than the window');
    const [bar, stage] = await page.$$eval('#playback, #scale', (parts) => parts.map((part) => part.getBoundingClientRect().toJSON())
      .sort((a, b) => b.height - a.height));
    assert(stage.bottom <= bar.top, 'the bar lies over the scale');
    await page.evaluate(axe);
    const found = await page.evaluate(() => globalThis.axe.run().then(({violations}) => violations.map(({id, nodes}) =>
      `${id}: ${nodes.map((element) => element.html.slice(0, 120)).join(' | ')}`)));
    assert.deepEqual(found, []);
  },

  async 'the same in German'(name, theme) {
    await page.click('#language-button');
    await says('#playback', /Aufzeichnung/);
    await says('#doing', / nach office-3, noch /);
    assert.equal(await page.getAttribute('html', 'lang'), 'de');
    assert.equal(await page.getAttribute('#help-button', 'aria-label'), 'Hilfe');
    await page.waitForFunction(() => Number(document.querySelector('#map').dataset.tiles) > 5);
    await look('playback-german', name, theme);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false, 'German is wider than the window');
    await page.click('#language-button');
    await says('#playback', /Recorded log/);
  },
};

async function compareWithItsDescription() {
  const Ajv = createRequire(`${folder}/`)('ajv/dist/2020').default;
  const ajv = new Ajv({allErrors: true, strict: false, validateFormats: false});
  ajv.addSchema(await ask('api/openapi.json'), 'api');
  const check = (schema, value) => {
    const valid = ajv.getSchema(`api#/components/schemas/${schema}`);
    assert(valid(value), ajv.errorsText(valid.errors));
  };
  const all = await ask('api/playback');
  check('Playback', all);
  check('PlaybackState', all.state);
  check('Settings', await ask('settings.json'));
  for (const [text, status] of [[{}, 400], [{speed: 17}, 400], [{position: -1}, 400], [{strange: 1}, 400], [{speed: 2}, 200]]) {
    assert.equal((await order(text)).status, status, JSON.stringify(text));
  }
}

const viewer = view(`${kept}/drive.lcm`);
let failure = null;
try {
  address = await viewer.address;
  await compareWithItsDescription();
  for (const [name, screen] of Object.entries(SCREENS)) {
    for (const theme of ['light', 'dark']) {
      if (!`${name}, ${theme}`.startsWith(only)) continue;
      page = await (await browser.newContext({...screen, colorScheme: theme})).newPage();
      page.setDefaultTimeout(60_000);
      page.on('pageerror', (error) => { failure ??= error; });
      await page.goto(address);
      for (const [title, step] of Object.entries(steps)) {
        await step(name, theme).catch((error) => { error.message = `${name}, ${theme}: ${title}: ${error.message}`; throw error; });
      }
      await page.context().close();
      console.log(`ok  ${name}, ${theme}`);
    }
  }
} catch (error) {
  failure = error;
  await look('failed-playback', '', '').catch(() => {});
}
console.log(failure ? `FAILED: ${failure.stack}` : 'passed');
await browser.close();
await end(viewer);
process.exit(failure ? 1 : 0);
