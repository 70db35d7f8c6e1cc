// What happened, in the order of time, kept over a reload of the page: goals, stops, losses, faults.
import {download} from './map_picture.js';
import {NAVIGATION, POSE, nameOf, spot} from './names.js';
import {t, translated} from './texts.js';

const KEPT = 300;
const SHOWN = 60;
const STALE_S = 1.0;
const ENDS = {arrived: '', 'no path': 'warn', blocked: 'warn', stuck: 'warn', cancelled: '', lost: 'bad', paused: ''};
const BEGINS = ['localizing', 'planning', 'following'];

const isFresh = (age) => age !== undefined && age < STALE_S;
const two = (number) => String(number).padStart(2, '0');
const clockOf = (at) => { const t = new Date(at); return `${two(t.getHours())}:${two(t.getMinutes())}:${two(t.getSeconds())}`; };

// What is different in two states that follow each other: [[text, tone], ...]. Words that stopped coming say nothing.
export function changes(before, now, building) {
  const said = [];
  const {robot, pose, navigation, ages} = now;
  if (pose && isFresh(ages.POSE) && before.pose && before.pose.state !== pose.state) {
    const word = nameOf(POSE, pose.state);
    if (word === 'TRACKING') said.push([t`knows where it is: ${spot([pose.x, pose.y], building)}`, '']);
    else if (nameOf(POSE, before.pose.state) === 'TRACKING') said.push([t`does not know where it is any more: ${pose.reason}`, 'bad']);
  }
  if (navigation && before.navigation && before.navigation.state !== navigation.state) {
    const [was, is] = [before, now].map((state) => nameOf(NAVIGATION, state.navigation.state));
    const where = navigation.target ? spot(navigation.target, building) : '';
    const end = where && is === 'arrived' ? t`arrived at ${where}` : translated(is);
    if (is in ENDS) said.push([is === 'arrived' || !navigation.cause ? end : `${end}: ${navigation.cause}`, ENDS[is]]);
    else if (BEGINS.includes(is) && !BEGINS.includes(was)) said.push([where ? t`sets out to ${where}` : t`sets out`, '']);
  }
  if (robot && isFresh(ages.ROBOT_STATUS) && before.robot) {
    const turned = (key) => Boolean(robot[key]) !== Boolean(before.robot[key]);
    if (turned('connected')) said.push(robot.connected ? [t`the robot is connected`, ''] : [t`the robot is not connected any more`, 'bad']);
    if (turned('stop_engaged')) said.push([robot.stop_engaged ? `STOP${robot.reason ? `: ${robot.reason}` : ''}` : t`STOP is released`, robot.stop_engaged ? 'warn' : '']);
    if (turned('stop_button')) said.push([robot.stop_button ? t`the button on the robot is pressed` : t`the button on the robot is let go`, 'warn']);
    if (turned('motors_enabled')) said.push([robot.motors_enabled ? t`motors on` : t`motors off`, '']);
    if (turned('stall') && robot.stall) said.push([t`a wheel is blocked`, 'bad']);
  }
  return said;
}

export class Happenings {
  constructor({list, save, clear}, storage = localStorage) {
    Object.assign(this, {list, storage, before: null, restarts: new Map(), isOff: false});
    try { this.entries = JSON.parse(storage.getItem('happenings')) ?? []; } catch { this.entries = []; }
    save.addEventListener('click', () => this.download());
    clear.addEventListener('click', () => { this.entries = []; this.keep(); });
    this.show();
  }

  // A log that is shown fills the list itself.
  turnOff() {
    this.isOff = true;
    this.list.replaceChildren();
  }

  watch(state, building) {
    if (this.isOff) return;
    if (this.before) for (const [text, tone] of changes(this.before, state, building)) this.add(text, tone);
    this.before = state;
  }

  // A process that was started anew.
  watchProcesses({commands}) {
    for (const {name, restarts} of commands ?? []) {
      if (this.restarts.has(name) && restarts > this.restarts.get(name)) this.add(t`${name} was started anew`, 'warn');
      this.restarts.set(name, restarts);
    }
  }

  add(text, tone = '') {
    if (this.isOff) return;
    this.entries.push({at: Date.now(), text, tone});
    this.entries = this.entries.slice(-KEPT);
    this.keep();
  }

  keep() {
    try { this.storage.setItem('happenings', JSON.stringify(this.entries)); } catch { /* a browser that keeps nothing */ }
    this.show();
  }

  show() {
    this.list.replaceChildren(...this.entries.slice(-SHOWN).reverse().map(({at, text, tone}) => {
      const line = document.createElement('li');
      const time = Object.assign(document.createElement('time'), {textContent: clockOf(at), dateTime: new Date(at).toISOString()});
      line.append(time, Object.assign(document.createElement('span'), {textContent: text, className: tone}));
      return line;
    }));
  }

  download() {
    const text = this.entries.map(({at, text: said}) => `${new Date(at).toISOString()} ${said}\n`).join('');
    download(new Blob([text], {type: 'text/plain'}), 'luminav-events.txt');
  }
}
