// survey_test.mjs SOURCE BIN FOLDER: somebody surveys a building with the simulated robot, by hand, from a page and a phone;
// the surveyor is killed on the way. Needs a network namespace of its own and playwright-core under FOLDER.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {existsSync, mkdirSync, readFileSync, rmSync} from 'node:fs';
import {createRequire} from 'node:module';
import {userInfo} from 'node:os';
import {setTimeout as sleep} from 'node:timers/promises';

import {Page} from './page.mjs';
import {ADDRESS, RunningSystem, until} from './running_system.mjs';

const [source, bin, folder] = process.argv.slice(2);
const require = createRequire(`${folder}/`);
const {chromium} = require('playwright-core');
const Ajv = require('ajv/dist/2020').default;
const executablePath = process.env.LUMINAV_CHROMIUM ?? '/usr/bin/chromium';
if (!existsSync(executablePath)) {
  console.log(`skipped: no ${executablePath}`);
  process.exit(77);
}

mkdirSync(`${folder}/pictures`, {recursive: true});
const out = `${folder}/surveyed`;
rmSync(out, {recursive: true, force: true});
const browser = await chromium.launch({executablePath, args: userInfo().uid === 0 ? ['--no-sandbox'] : []});
const system = new RunningSystem(source, bin, folder);
system.environment = {...process.env, LUMINAV_BIN: bin, LUMINAV_STATE: system.stateFolder};
const pages = [];
const survey = () => system.news.survey;

async function driveUntil(page, key, what, holds) {
  await page.page.keyboard.down(key);
  await until(what, 90, holds);
  await page.page.keyboard.up(key);
}

// What is served is what openapi.json says.
async function keepsTheContract() {
  const ajv = new Ajv({allErrors: true, strict: false, validateFormats: false});
  ajv.addSchema(await (await fetch(`${ADDRESS}/api/openapi.json`)).json(), 'api');
  const valid = ajv.getSchema('api#/components/schemas/Survey');
  const read = await (await fetch(`${ADDRESS}/api/survey`)).json();
  for (const said of [survey(), read]) assert.ok(valid(said), ajv.errorsText(valid.errors));
}

async function surveyTheBuilding() {
  system.start('launch', `${source}/scripts/survey`, ['--live', out, '--simulated']);
  await until('the viewer serves', 30, () => fetch(`${ADDRESS}/settings.json`).then((answer) => answer.ok, () => false));
  system.listen();
  const desk = await Page.open(browser, ADDRESS, `${folder}/pictures`, 'desktop', {viewport: {width: 1440, height: 900}, colorScheme: 'light'});
  const phone = await Page.open(browser, ADDRESS, `${folder}/pictures`, 'phone', {viewport: {width: 390, height: 844}, hasTouch: true,
    isMobile: true, deviceScaleFactor: 2, colorScheme: 'dark'});
  pages.push(desk, phone);
  await until('the survey is shown', 20, () => desk.isShown('#survey-card'));
  await until('the motors can be switched on or are', 20, () => system.state.robot?.connected);
  if (await desk.isShown('#motors')) await desk.press('#motors');
  await desk.press('#keys');
  await driveUntil(desk, 'ArrowUp', 'it has driven 4 m', () => survey()?.distance > 4);
  await desk.page.fill('#survey-name', 'lift');
  await desk.press('#survey-place button');
  await until('the place is on the map', 5, () => survey().places.some(({name}) => name === 'lift'));

  process.kill(Number(execFileSync('pgrep', ['-f', `surveyor --robot .*${out}`])), 'SIGKILL');
  const before = survey();
  await until('the surveyor goes on', 15, () => survey().utime > before.utime + 1e6 && survey().distance >= before.distance);
  assert.ok(survey().places.some(({name}) => name === 'lift'));
  await driveUntil(desk, 'ArrowUp', 'it has driven 9 m', () => survey().distance > 9);
  await driveUntil(desk, 'ArrowDown', 'there is an estimate', () => survey().estimated_distance > 0 && survey().distance > 12);
  assert.ok(survey().fixtures.filter(({provisional}) => !provisional).length >= 3, JSON.stringify(survey().fixtures));
  await desk.says('#survey-figures', /driven · \d+ lamps/);
  await keepsTheContract();
  await desk.picture('survey-desktop');
  await phone.page.$eval('#survey-card', (card) => card.scrollIntoView());
  await phone.picture('survey-phone-card');
  await phone.page.$eval('#map', (canvas) => canvas.scrollIntoView({block: 'end'}));
  await phone.picture('survey-phone');
  await desk.press('#survey-finish');
  await desk.says('#survey-state', /Finished/, 30);
  await desk.picture('survey-finished-desktop');
  const building = readFileSync(`${out}/building.toml`, 'utf8');
  assert.match(building, /name = "lift"/);
  assert.ok(building.split('[[fixture]]').length > 3);
  const complaints = pages.flatMap((page) => page.complaints);
  if (complaints.length > 0) throw new Error(`errors in the pages: ${complaints.join('; ')}`);
}

let failure = null;
try {
  await Promise.race([surveyTheBuilding(), sleep(310_000, undefined, {ref: false}).then(() => { throw new Error('the test takes too long'); })]);
} catch (error) {
  failure = error;
  console.log(`FAILED: ${error.stack}`);
  for (const page of pages) await page.picture(`failed-${page.name}`).catch(() => {});
  console.log(`--- launch\n${system.tail('launch')}`);
} finally {
  await browser.close();
  await system.endAll();
}
process.exit(failure ? 1 : 0);
