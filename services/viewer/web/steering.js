// A person's hand on the robot: a stick for fingers and mice, and keys. Dead-man: commands go out ten times a second for
// as long as somebody holds; with none for 0.3 s the robot stops by itself.
import * as commands from './commands.js';
import {t} from './texts.js';

const PERIOD_MS = 100;
const SILENT_S = 0.7;   // the page that hears nothing knows nothing: then it doesn't steer either
const KEY_SHARE = 0.6;  // of full speed, for keys cannot be pressed by half
const KEYS = {
  ArrowUp: [1, 0], KeyW: [1, 0], ArrowDown: [-1, 0], KeyS: [-1, 0],
  ArrowLeft: [0, 1], KeyA: [0, 1], ArrowRight: [0, -1], KeyD: [0, -1],
};

export class Steering {
  constructor({stick, knob, keysButton, word}, connection) {
    Object.assign(this, {stick, knob, keysButton, word, connection});
    this.limits = null;        // {linear, angular}: the robot's
    this.held = null;          // [forward, turn], each -1..1; null = nobody holds
    this.pressed = new Set();  // keys
    this.session = Date.now() * 1000 + Math.floor(Math.random() * 1000);
    this.sequence = 0;
    this.underway = 0;
    stick.addEventListener('pointerdown', (event) => {
      stick.setPointerCapture(event.pointerId);
      this.pull(event);
    });
    stick.addEventListener('pointermove', (event) => {
      if (stick.hasPointerCapture(event.pointerId)) this.pull(event);
    });
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) stick.addEventListener(end, () => this.hold(null));
    stick.addEventListener('contextmenu', (event) => event.preventDefault());
    keysButton.addEventListener('click', () => this.useKeys(keysButton.getAttribute('aria-pressed') !== 'true'));
    addEventListener('keydown', (event) => this.key(event, true));
    addEventListener('keyup', (event) => this.key(event, false));
    addEventListener('blur', () => this.letGo());
    document.addEventListener('visibilitychange', () => { if (document.hidden) this.letGo(); });
    setInterval(() => { if (this.held) this.send(this.held); }, PERIOD_MS);
  }

  useKeys(isOn) {
    this.keysButton.setAttribute('aria-pressed', String(isOn));
    if (!isOn) this.letGo();
  }

  letGo() {
    this.pressed.clear();
    this.hold(null);
  }

  key(event, isDown) {
    if (this.keysButton.getAttribute('aria-pressed') !== 'true' || !KEYS[event.code] || event.ctrlKey || event.altKey
      || event.metaKey) return;
    event.preventDefault();
    if (event.repeat) return;
    if (isDown) this.pressed.add(event.code); else this.pressed.delete(event.code);
    const pulls = [...this.pressed].map((code) => KEYS[code]);
    const sum = (axis) => KEY_SHARE * Math.max(-1, Math.min(1, pulls.reduce((total, pull) => total + pull[axis], 0)));
    this.hold(pulls.length ? [sum(0), sum(1)] : null);
  }

  pull(event) {
    const box = this.stick.getBoundingClientRect();
    const radius = box.width / 2;
    const [right, down] = [(event.clientX - box.left) / radius - 1, (event.clientY - box.top) / radius - 1];
    const stretch = Math.max(1, Math.hypot(right, down));
    this.hold([-down / stretch, -right / stretch]);
  }

  hold(held) {
    const wasHeld = this.held;
    this.held = held;
    const [forward, turn] = held ?? [0, 0];
    this.knob.style.transform = `translate(${-turn * 40}px, ${-forward * 40}px)`;
    this.stick.classList.toggle('held', Boolean(held));
    if (held && !wasHeld) this.send(held);
    if (!held && wasHeld) { this.send([0, 0]); this.word.textContent = ''; }
  }

  async send([forward, turn]) {
    if (!this.limits || this.underway > 2) return;  // a line that is full carries nothing fresh
    if (this.connection.silence() > SILENT_S) { this.word.textContent = t`no connection`; return; }
    ++this.underway;
    try {
      await commands.steer({session: this.session, sequence: ++this.sequence, linear: forward * this.limits.linear,
        angular: turn * this.limits.angular, seen: this.connection.serverTime()});
      this.word.textContent = this.held ? t`steering` : '';
    } catch (error) {
      this.word.textContent = error.refused ? error.message : t`no connection`;
    } finally {
      --this.underway;
    }
  }
}
