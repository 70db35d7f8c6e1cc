// A recorded log in place of a running robot: its timeline, with marks where the pose was lost, a goal was given or a stop was
// engaged. Nothing is sent to any robot.
import * as commands from './commands.js';
import {locale, t} from './texts.js';

const $ = (id) => document.getElementById(id);
const STEP_S = 5;       // of the arrow keys
const SCRUB_MS = 150;   // between two jumps while the slider is dragged
const TONES = {goal: '', stop: 'warn', lost: 'bad'};

const two = (number) => String(number).padStart(2, '0');
export const minutes = (seconds) => `${Math.floor(seconds / 60)}:${two(Math.floor(seconds % 60))}`;

function wordsOf({kind, text}) {
  if (kind === 'goal') return t`sets out to ${text}`;
  if (kind === 'stop') return text ? `STOP: ${text}` : 'STOP';
  return t`does not know where it is any more: ${text}`;
}

export class Playback extends EventTarget {
  // Says "jump" when what was shown no longer holds. `ask(subject, send, what)` sends a request and reports.
  constructor(ask, connection) {
    super();
    Object.assign(this, {ask, isOn: false, state: null, marks: [], held: 0, wanted: null});
    commands.settings.then(({shows_log: showsLog}) => { if (showsLog) this.begin(); });
    connection.addEventListener('playback', ({detail}) => this.show(detail));
    $('play').addEventListener('click', () => this.toggle());
    $('speed').addEventListener('change', () => this.order({speed: Number($('speed').value)}));
    const slider = $('position');
    slider.addEventListener('input', () => this.scrub(Number(slider.value)));
    slider.addEventListener('keydown', (event) => {
      const steps = {ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1}[event.key];
      if (!steps) return;
      event.preventDefault();
      this.jump(this.state.position + steps * STEP_S);
    });
  }

  begin() {
    if (this.isOn) return;
    this.isOn = true;
    document.body.classList.add('playback');
    $('playback').hidden = false;
    this.dispatchEvent(new Event('begin'));
    fetch('api/playback').then((answer) => answer.json()).then(({marks}) => this.showMarks(marks)).catch(() => {});
  }

  order(what) { return commands.playback(what).catch((error) => this.ask('log', () => { throw error; }, '')); }
  toggle() { this.order({playing: !this.state?.playing}); }
  jump(position) { if (this.state) this.order({position: Math.min(Math.max(position, 0), this.state.duration)}); }

  // The last place counts, and those on the way only now and then.
  scrub(position) {
    if (!this.state) return;
    this.held = performance.now();
    this.label(position);
    if (this.wanted === null) {
      setTimeout(() => { this.jump(this.wanted); this.wanted = null; }, SCRUB_MS);
    }
    this.wanted = position;
  }

  show(state) {
    this.begin();
    const isJump = this.state && this.state.jumps !== state.jumps;
    const isFirst = !this.state;
    this.state = state;
    if (isFirst) {
      $('position').max = state.duration;
      $('log-name').textContent = state.file;
      $('log-damage').textContent = state.damage;
      this.showMarks(this.marks);
    }
    $('play').textContent = state.playing ? '❚❚' : '▶';
    $('play').setAttribute('aria-label', state.playing ? t`Pause` : t`Play`);
    $('play').title = state.playing ? t`Pause (space bar)` : t`Play (space bar)`;
    if (document.activeElement !== $('speed')) $('speed').value = String(state.speed);
    if (this.wanted === null && performance.now() - this.held > 2 * SCRUB_MS) {
      $('position').value = state.position;
      this.label(state.position);
    }
    if (isJump) this.dispatchEvent(new Event('jump'));
  }

  label(position) {
    $('time').textContent = `${minutes(position)} / ${minutes(this.state.duration)}`;
    $('position').setAttribute('aria-valuetext', t`${minutes(position)} of ${minutes(this.state.duration)}`);
    $('log-time').textContent = new Date(this.state.begin / 1000 + position * 1000)
      .toLocaleString(locale, {dateStyle: 'medium', timeStyle: 'medium'});
  }

  showMarks(marks) {
    this.marks = marks;
    if (!this.state) return;
    const share = ({at}) => `${100 * at / Math.max(this.state.duration, 0.1)}%`;
    $('marks').replaceChildren(...marks.map((mark) => {
      const tick = Object.assign(document.createElement('i'), {title: `${minutes(mark.at)} ${wordsOf(mark)}`, className: mark.kind});
      tick.style.left = share(mark);
      tick.addEventListener('click', () => this.jump(mark.at));
      return tick;
    }));
    $('happened').replaceChildren(...marks.map((mark) => {
      const line = document.createElement('li');
      const button = Object.assign(document.createElement('button'), {className: 'small', textContent: minutes(mark.at)});
      button.addEventListener('click', () => this.jump(mark.at));
      line.append(button, Object.assign(document.createElement('span'), {textContent: wordsOf(mark), className: TONES[mark.kind]}));
      return line;
    }));
  }
}
