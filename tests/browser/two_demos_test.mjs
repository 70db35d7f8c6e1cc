// two_demos_test SOURCE BIN FOLDER: two demos side by side on one machine, each with its own page: what is done to one robot does
// nothing to the other. Needs a network namespace of its own and playwright-core under FOLDER.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {createWriteStream, readFileSync} from 'node:fs';
import {once} from 'node:events';
import {setTimeout as sleep} from 'node:timers/promises';

import {startBrowser} from './pretended_viewer.mjs';

const [source, bin, folder] = process.argv.slice(2);
const SECONDS = 150;  // for what a machine does in ten when it has nothing else to do
const browser = await startBrowser(folder);

class Demo {
  constructor(id) {
    this.address = `http://127.0.0.1:${8080 + 2 * id}`;
    this.file = `${folder}/demo-${id}.log`;
    this.child = spawn(`${bin}/demo`, ['--view', '--headless', '--id', String(id), '--scenario', `${source}/tests/system/near_goal.toml`],
      {stdio: ['ignore', 'pipe', 'pipe'], detached: true});
    const log = createWriteStream(this.file);
    for (const stream of [this.child.stdout, this.child.stderr]) stream.pipe(log);
  }

  async open() {
    await until(`${this.address} serves`, () => fetch(`${this.address}/settings.json`).then((answer) => answer.ok, () => false));
    this.page = await (await browser.newContext({viewport: {width: 1000, height: 800}})).newPage();
    await this.page.goto(this.address);
  }

  state() { return fetch(`${this.address}/api/state`).then((answer) => answer.json()); }
  says(selector, pattern) { return until(`${this.address} says ${pattern}`, async () => pattern.test(await this.page.innerText(selector))); }

  async end() {
    if (this.child.exitCode !== null) return;
    process.kill(this.child.pid, 'SIGINT');
    await Promise.race([once(this.child, 'exit'), sleep(20_000)]);
  }
}

async function until(what, holds) {
  const end = performance.now() + 1000 * SECONDS;
  while (!await holds().catch(() => false)) {
    if (performance.now() > end) throw new Error(`${what}: not within ${SECONDS} s`);
    await sleep(200);
  }
}

const demos = [new Demo(1), new Demo(2)];
let failure = null;
try {
  for (const demo of demos) await demo.open();
  const [one, other] = demos;
  for (const demo of demos) await demo.says('#pose-state', /TRACKING/);
  const [a, b] = [await one.state(), await other.state()];
  assert.notEqual(a.odometry.session, b.odometry.session, 'both pages show one robot');
  for (const demo of demos) {
    await demo.page.screenshot({path: `${folder}/pictures/two-demos-${demo.address.slice(-4)}.png`});
    const processes = await (await fetch(`${demo.address}/api/processes`)).json();
    assert.equal(processes.commands.filter(({name}) => name === 'planner').length, 1, `planners of ${demo.address}`);
  }
  await one.page.click('#stop');
  await one.says('#stop-state', /The robot stands/);
  assert.equal((await other.state()).robot.stop_engaged, false, 'a STOP on one page stops both');
  await until('the other one arrives', async () => (await other.state()).navigation.state === 5);
  await one.page.click((await one.page.isVisible('#release-go')) ? '#release-go' : '#release');
  await until('the stop is released', async () => !(await one.state()).robot.stop_engaged);
  console.log(`passed: ${demos.map(({address}) => address).join(' and ')}`);
} catch (error) {
  failure = error;
  console.log(`FAILED: ${error.stack}`);
} finally {
  await browser.close();
  for (const demo of demos) await demo.end();
  if (failure) for (const {file} of demos) console.log(`--- ${file}\n${readFileSync(file, 'utf8').split('\n').slice(-12).join('\n')}`);
}
process.exit(failure ? 1 : 0);
