// STOP, from the finger to the robot's own word that it stands; and whether it would get there, before it is needed.
import * as commands from './commands.js';
import {t} from './texts.js';

const $ = (id) => document.getElementById(id);
const BEAT_MS = 1000;
const UNREACHED_MS = 2500;  // two beats in a row went nowhere
const RETRY_MS = 300;
const STILL = 0.02;         // [m/s, rad/s]
const STALE_S = 1.0;
const UNDERWAY = ['localizing', 'planning', 'following', 'waiting', 'blocked', 'stuck', 'paused'];

const seconds = (since) => Math.round((performance.now() - since) / 1000);

export class Stop {
  // `ask(subject, send, what)` sends a request and reports; `navigationName(state)` names one.
  constructor(ask, navigationName) {
    Object.assign(this, {ask, navigationName, state: null, pressed: 0, sending: 0, reached: performance.now(), mayCommand: true,
      why: '', said: null, isOff: false});
    $('release').addEventListener('click', () => this.release(false));
    $('release-go').addEventListener('click', () => this.release(true));
    document.addEventListener('visibilitychange', () => { if (!document.hidden) { this.reached = performance.now(); this.beat(); } });
    setInterval(() => this.beat(), BEAT_MS);
    setInterval(() => this.render(), 200);
    this.beat();
  }

  // A page in view asks once a second, the way that a STOP would go.
  async beat() {
    if (document.hidden || this.isOff) return;
    try {
      this.mayCommand = await commands.watch();
      this.reached = performance.now();
      this.why = '';
    } catch (error) {
      this.why = error.refused ? error.message : t`the viewer does not answer`;
    }
    this.render();
  }

  // There is no robot to be stopped.
  turnOff() {
    this.isOff = true;
    this.render();
  }

  isOutOfReach() { return !this.isOff && performance.now() - this.reached > UNREACHED_MS; }

  // Goes on until it got through, and says so all the while.
  async press() {
    if (this.isOff) return;
    this.pressed = performance.now();
    $('stop').classList.add('pressed');
    setTimeout(() => $('stop').classList.remove('pressed'), 300);
    this.say(t`Sending STOP …`, '');
    const mine = ++this.sending;
    const since = this.pressed;
    while (mine === this.sending) {
      try {
        await commands.stop();
        const took = seconds(since);
        if (mine === this.sending) this.sending = 0;
        this.say(took > 1 ? t`STOP got through after ${took} s.` : '', 'warn', 6000);
        break;
      } catch (error) {
        if (mine !== this.sending) break;
        this.say(t`STOP has not got through for ${Math.max(1, seconds(since))} s: ${error.message}. Use the button on the robot! Trying on …`, 'bad');
        await new Promise((later) => { setTimeout(later, RETRY_MS); });
      }
    }
    this.render();
  }

  say(text, tone, forMs = 0) {
    this.said = text ? {text, tone, until: forMs ? performance.now() + forMs : Infinity} : null;
    this.render();
  }

  async release(goesOn) {
    const isUnderway = this.isUnderway();
    await this.ask('release', async () => {
      if (isUnderway && !goesOn) {
        await commands.goal('pause');
        await this.until(() => this.navigationName(this.state?.navigation?.state) === 'paused',
          t`the planner does not pause, so the stop is kept`);
      }
      await commands.release();
    }, goesOn ? t`of the stop, and on` : t`of the stop`);
  }

  async until(holds, otherwise) {
    const end = performance.now() + 2000;
    while (!holds()) {
      if (performance.now() > end) throw new Error(otherwise);
      await new Promise((later) => { setTimeout(later, 50); });
    }
  }

  show(state) {
    this.state = state;
    this.render();
  }

  isUnderway() {
    const {navigation, ages} = this.state ?? {};
    return Boolean(navigation) && ages.NAVIGATION_STATUS < 3 && UNDERWAY.includes(this.navigationName(navigation.state));
  }

  // What the robot itself says of it; a word that stopped coming counts for nothing.
  facts() {
    const {robot, control, ages = {}, requests = []} = this.state ?? {};
    const isHeard = Boolean(robot) && ages.ROBOT_STATUS < STALE_S;
    const request = requests.find(({kind, engages}) => kind === 'stop' && engages);
    return {
      isEngaged: Boolean((isHeard && robot.stop_engaged) || (control?.stop_engaged && ages.CONTROL_STATUS < STALE_S)),
      stands: isHeard && robot.stop_engaged && Math.abs(robot.linear ?? 1) < STILL && Math.abs(robot.angular ?? 1) < STILL,
      isPending: request?.fate === 'waiting',
      pendingFor: request?.age ?? 0,
    };
  }

  render() {
    if (this.isOff) { $('stop-banner').hidden = $('no-token').hidden = true; return; }
    const {isEngaged, stands, isPending, pendingFor} = this.facts();
    const word = this.sending ? t`Sending STOP …` : stands ? t`The robot stands` : isEngaged ? t`Stopping …`
      : isPending ? t`STOP is sent, not obeyed yet` : this.isOutOfReach() ? t`No way to the robot` : '';
    if ($('stop-state').textContent !== word) $('stop-state').textContent = word;
    $('stop').classList.toggle('engaged', isEngaged);
    $('stop').classList.toggle('unreached', this.isOutOfReach());
    $('releases').hidden = !(isEngaged || isPending);
    document.body.classList.toggle('stopped', isEngaged || isPending);
    const stopTitle = stands ? t`STOPPED` : 'STOP';
    if ($('stop-title').textContent !== stopTitle) $('stop-title').textContent = stopTitle;
    const underway = this.isUnderway();
    $('release-go').hidden = !underway;
    const title = underway ? t`Release, stay here` : t`Release stop`;
    if ($('release').textContent !== title) $('release').textContent = title;

    if (this.said && performance.now() > this.said.until) this.said = null;
    const pending = isPending && !this.sending && pendingFor > 0.6
      ? t`STOP was sent ${Math.round(pendingFor)} s ago, but driver and controller have not both obeyed yet: it is repeated until they do.` : '';
    const unreached = this.isOutOfReach()
      ? t`You cannot stop the robot from here: ${this.why || t`the viewer does not answer`}. Use the button on the robot.` : '';
    const text = this.said?.text || unreached || pending;
    const banner = $('stop-banner');
    if (banner.textContent !== text) banner.textContent = text;
    banner.hidden = !text;
    banner.className = this.said?.text ? this.said.tone : unreached ? 'bad' : 'warn';
    $('no-token').hidden = this.mayCommand;
  }
}
