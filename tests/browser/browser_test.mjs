// browser_test.mjs SOURCE BIN FOLDER: a person with a desktop browser and one with a phone use a robot together.
// Needs a network namespace of its own and playwright-core under FOLDER. Pictures and logs stay in FOLDER.
import {existsSync, mkdirSync} from 'node:fs';
import {createRequire} from 'node:module';
import {userInfo} from 'node:os';
import {setTimeout as sleep} from 'node:timers/promises';

import {byHand, connection, managing} from './hand_steps.mjs';
import {Page} from './page.mjs';
import {ADDRESS, RunningSystem} from './running_system.mjs';
import {driving, localizing, stopping} from './steps.mjs';

const [source, bin, folder] = process.argv.slice(2);
const {chromium} = createRequire(`${folder}/`)('playwright-core');

async function startBrowser() {
  const executablePath = process.env.LUMINAV_CHROMIUM ?? '/usr/bin/chromium';
  try {
    return await chromium.launch({executablePath, args: userInfo().uid === 0 ? ['--no-sandbox'] : [],
      handleSIGINT: false, handleSIGTERM: false, handleSIGHUP: false});
  } catch (error) {
    console.log(`skipped: ${existsSync(executablePath) ? 'chromium cannot start here' : `no ${executablePath}`}: ` +
      error.message.split('\n')[0]);
    process.exit(77);
  }
}

mkdirSync(`${folder}/pictures`, {recursive: true});
const browser = await startBrowser();
const system = new RunningSystem(source, bin, folder);
const pages = [];

async function useTheRobot() {
  system.launch();
  await system.view();
  system.listen();
  const open = (name, options) => Page.open(browser, ADDRESS, `${folder}/pictures`, name, options);
  const desk = await open('desktop', {viewport: {width: 1440, height: 900}, colorScheme: 'light'});
  pages.push(desk);
  const phone = await open('phone', {viewport: {width: 390, height: 844}, hasTouch: true, isMobile: true,
    deviceScaleFactor: 2, colorScheme: 'dark'});
  pages.push(phone);
  for (const [title, step] of Object.entries({...localizing, ...driving, ...stopping, ...byHand, ...managing, ...connection})) {
    const began = performance.now();
    const said = await step({system, desk, phone, folder});
    console.log(`ok  ${((performance.now() - began) / 1000).toFixed(1).padStart(5)} s  ${title}${said ? `: ${said}` : ''}`);
  }
  const complaints = pages.flatMap((page) => page.complaints);
  if (complaints.length > 0) throw new Error(`errors in the pages: ${complaints.join('; ')}`);
}

async function after(seconds, what) {
  await sleep(1000 * seconds, undefined, {ref: false});
  throw new Error(what);
}

// Whatever ends the test, nothing that it started is left.
const interrupted = new Promise((resolve, reject) => {
  for (const signal of ['SIGINT', 'SIGTERM', 'SIGHUP']) process.on(signal, () => reject(new Error(signal)));
});
let failure = null;
try {
  await Promise.race([useTheRobot(), after(240, 'the test takes too long'), interrupted]);
} catch (error) {
  failure = error;
  console.log(`FAILED: ${error.stack}`);
  for (const page of pages) await page.picture(`failed-${page.name}`).catch(() => {});
  for (const name of ['launch', 'viewer']) console.log(`--- ${name}\n${system.tail(name)}`);
} finally {
  await browser.close();
  await system.endAll();
}
process.exit(failure ? 1 : 0);
