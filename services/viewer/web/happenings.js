// What happened, in the order of time, kept over a reload of the page: goals, stops, losses, faults.
import {download} from './map_picture.js';
import {NAVIGATION, POSE, nameOf, spot} from './names.js';

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
    if (word === 'TRACKING') said.push([`knows where it is: ${spot([pose.x, pose.y], building)}`, '']);
    else if (nameOf(POSE, before.pose.state) === 'TRACKING') said.push([`does not know where it is any more: ${pose.reason}`, 'bad']);
  }
  if (navigation && before.navigation && before.navigation.state !== navigation.state) {
    const [was, is] = [before, now].map((state) => nameOf(NAVIGATION, state.navigation.state));
    const where = navigation.target ? ` ${spot(navigation.target, building)}` : '';
    if (is in ENDS) said.push([is === 'arrived' ? `arrived${where && ` at${where}`}` : `${is}${navigation.cause ? `: ${navigation.cause}` : ''}`, ENDS[is]]);
    else if (BEGINS.includes(is) && !BEGINS.includes(was)) said.push([`sets out${where && ` to${where}`}`, '']);
  }
  if (robot && isFresh(ages.ROBOT_STATUS) && before.robot) {
    const turned = (key) => Boolean(robot[key]) !== Boolean(before.robot[key]);
    if (turned('connected')) said.push(robot.connected ? ['the robot is connected', ''] : ['the robot is not connected any more', 'bad']);
    if (turned('stop_engaged')) said.push([robot.stop_engaged ? `STOP${robot.reason ? `: ${robot.reason}` : ''}` : 'STOP is released', robot.stop_engaged ? 'warn' : '']);
    if (turned('stop_button')) said.push([robot.stop_button ? 'the button on the robot is pressed' : 'the button on the robot is let go', 'warn']);
    if (turned('motors_enabled')) said.push([`motors ${robot.motors_enabled ? 'on' : 'off'}`, '']);
    if (turned('stall') && robot.stall) said.push(['a wheel is blocked', 'bad']);
  }
  return said;
}

export class Happenings {
  constructor({list, save, clear}, storage = localStorage) {
    Object.assign(this, {list, storage, before: null, restarts: new Map()});
    try { this.entries = JSON.parse(storage.getItem('happenings')) ?? []; } catch { this.entries = []; }
    save.addEventListener('click', () => this.download());
    clear.addEventListener('click', () => { this.entries = []; this.keep(); });
    this.show();
  }

  watch(state, building) {
    if (this.before) for (const [text, tone] of changes(this.before, state, building)) this.add(text, tone);
    this.before = state;
  }

  // A process that was started anew.
  watchProcesses({commands}) {
    for (const {name, restarts} of commands ?? []) {
      if (this.restarts.has(name) && restarts > this.restarts.get(name)) this.add(`${name} was started anew`, 'warn');
      this.restarts.set(name, restarts);
    }
  }

  add(text, tone = '') {
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
