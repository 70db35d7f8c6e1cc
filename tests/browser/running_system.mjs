// The whole system with the simulated robot, as a person starts it, and the viewer in front of it.
import {spawn} from 'node:child_process';
import {createWriteStream, mkdirSync, readFileSync, rmSync} from 'node:fs';
import {once} from 'node:events';
import {setTimeout as sleep} from 'node:timers/promises';

export const PORT = 8080;
export const ADDRESS = `http://127.0.0.1:${PORT}`;

export class RunningSystem {
  constructor(source, bin, folder) {
    Object.assign(this, {source, bin, folder, processes: new Map(), news: {}});
    this.stateFolder = `${folder}/state`;
    rmSync(this.stateFolder, {recursive: true, force: true});
    for (const name of ['launch', 'viewer']) rmSync(`${folder}/${name}.log`, {force: true});
    mkdirSync(this.stateFolder, {recursive: true});
    this.environment = {...process.env, LUMINAV_BIN: bin, LUMINAV_STATE: this.stateFolder,
      LUMINAV_SCENARIO: `${source}/tests/browser/open_floor.toml`, LUMINAV_SIMULATOR_PORT: '8101'};
  }

  start(name, program, args) {
    const log = createWriteStream(`${this.folder}/${name}.log`, {flags: 'a'});
    // a process group of its own: an interrupt reaches all of it, as Ctrl-C does at a terminal
    const child = spawn(program, args, {env: this.environment, stdio: ['ignore', 'pipe', 'pipe'], detached: true});
    child.stdout.pipe(log);
    child.stderr.pipe(log);
    this.processes.set(name, child);
    return child;
  }

  async end(name, signal = 'SIGTERM') {
    const child = this.processes.get(name);
    this.processes.delete(name);
    if (!child || child.exitCode !== null || child.signalCode !== null) return;
    process.kill(-child.pid, signal);
    await Promise.race([once(child, 'exit'), sleep(20_000)]);
  }

  launch() { this.start('launch', `${this.source}/scripts/launch`, [`${this.source}/launch/demo.pmd`]); }

  async view() {
    const launch = `${this.source}/launch`;
    this.start('viewer', `${this.bin}/viewer`, ['--robot', `${launch}/robots/p3dx.toml`, '--building',
      `${launch}/buildings/laboratory/building.toml`, '--port', String(PORT)]);
    await until('the viewer serves', 20, () => fetch(`${ADDRESS}/settings.json`).then((answer) => answer.ok, () => false));
  }

  record(file) { this.start('logger', 'lcm-logger', ['--quiet', '--channel=SIM_TRUTH|STOP', '--force', file]); }

  // Listens to the viewer's events, as the pages do; `news` holds the newest of each.
  async listen() {
    for (;;) {
      try {
        const answer = await fetch(`${ADDRESS}/events`);
        let text = '';
        for await (const piece of answer.body.pipeThrough(new TextDecoderStream())) {
          text += piece;
          for (let end = text.indexOf('\n\n'); end >= 0; end = text.indexOf('\n\n')) {
            this.take(text.slice(0, end));
            text = text.slice(end + 2);
          }
        }
      } catch { /* it is down: the test took it down */ }
      if (this.isOver) return;
      await sleep(100);
    }
  }

  take(event) {
    const [, name, data] = /event: (\w+)\ndata: (.*)/.exec(event) ?? [];
    if (name && name !== 'tile') this.news[name] = JSON.parse(data);
  }

  get state() { return this.news.state ?? {}; }
  get truth() { return this.state.truth; }

  distanceTo(x, y) { return Math.hypot(this.truth.x - x, this.truth.y - y); }

  async endAll() {
    this.isOver = true;
    await this.end('logger', 'SIGINT');
    await this.end('viewer');
    await this.end('launch', 'SIGINT');
  }

  tail(name) {
    try { return readFileSync(`${this.folder}/${name}.log`, 'utf8').split('\n').slice(-12).join('\n'); } catch { return ''; }
  }
}

const PATIENCE = 4;  // a busy machine takes that much longer than a quiet one

// Waits until something holds; says what did not, and what was seen last. `seconds`: ample on a quiet machine.
export async function until(what, seconds, holds, seen = () => '') {
  const end = performance.now() + 1000 * PATIENCE * seconds;
  for (;;) {
    const value = await holds();
    if (value) return value;
    if (performance.now() > end) throw new Error(`${what}: not within ${PATIENCE * seconds} s. ${seen()}`);
    await sleep(50);
  }
}
