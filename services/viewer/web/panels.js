// Words and figures beside the map.
import {Chart} from './charts.js';
import {guarded} from './guard.js';
import {CONTROL, EVERYBODY, EXPERTS, NAVIGATION, POSE, degrees, metres, nameOf, said, sentence, spot} from './names.js';
import {t, translated} from './texts.js';

const $ = (id) => document.getElementById(id);
const STALE_S = 1.0;  // the slowest of the channels that must not stop comes at 10 Hz

const OLD_S = 3.0;


function setText(element, text) { if (element.textContent !== text) element.textContent = text; }

export class Panels {
  constructor() {
    this.charts = {
      sigma: new Chart($('charts'), t`how sure (±)`, 'cm', 1, 5),
      speed: new Chart($('charts'), t`speed`, 'm/s', 2, 0.5),
      nis: new Chart($('charts'), t`innovation²`, '', 2, 2),
      error: new Chart($('charts'), t`true error`, 'cm', 1, 5),
    };
    this.charts.nis.figure.classList.add('numbers');
    this.charts.error.hide();
    this.facts = new Map();
    this.ages = {};
    for (const name of [...EVERYBODY, ...EXPERTS]) {  // their order is fixed, whoever speaks first
      const entry = {term: document.createElement('dt'), value: document.createElement('dd')};
      entry.term.textContent = translated(name);
      entry.term.classList.toggle('numbers', EXPERTS.includes(name));
      entry.term.hidden = entry.value.hidden = true;
      $('facts').append(entry.term, entry.value);
      this.facts.set(name, entry);
    }
    const show = (isOn) => {
      document.body.classList.toggle('experts', isOn);
      $('numbers').setAttribute('aria-pressed', String(isOn));
    };
    show(localStorage.getItem('numbers') === 'yes');
    $('numbers').addEventListener('click', () => {
      const isOn = !document.body.classList.contains('experts');
      localStorage.setItem('numbers', isOn ? 'yes' : 'no');
      show(isOn);
    });
  }

  // Nothing is known any more.
  clear() { for (const {term, value} of this.facts.values()) term.hidden = value.hidden = true; }

  // `channel`: whose word it is; one that stopped coming is shown as old.
  fact(name, value, tone = '', channel = '') {
    const entry = this.facts.get(name);
    const age = this.ages[channel];
    const isOld = age > OLD_S;
    entry.term.hidden = entry.value.hidden = false;
    setText(entry.value, isOld ? t`${value} (${Math.round(age)} s ago)` : value);
    entry.value.className = `${isOld ? 'old' : tone}${EXPERTS.includes(name) ? ' numbers' : ''}`;
  }

  // What a person must know at one look; a word that stopped coming is not shown as if it still held.
  show(state, building, isSurveying = false) {
    const {pose, robot, control, navigation, ages} = state;
    this.ages = ages;
    const poseIsOld = !pose || ages.POSE > STALE_S;
    const isTracking = !poseIsOld && pose.state === 2;
    guarded(t`the headline`, () => {
      const badge = $('pose-state');
      setText(badge, isSurveying ? t`survey` : poseIsOld ? t`no pose` : said(POSE, pose.state));
      badge.dataset.state = poseIsOld ? 'none' : nameOf(POSE, pose.state).toLowerCase();
      setText($('doing'), ages.ROBOT_STATUS > STALE_S ? t`No word from the robot.` : sentence(state, building));
    });
    if (pose) guarded(t`the pose`, () => this.showPose(pose, isTracking, building));
    if (navigation) guarded(t`the goal`, () => this.showGoal(navigation, building));
    if (control) guarded(t`the motion`, () => this.showControl(control));
    if (robot) guarded(t`the robot`, () => this.showRobot(robot));
    guarded(t`the truth`, () => this.showTruth(state, isTracking));
    $('motors').hidden = !robot || robot.motors_enabled || !robot.connected;
  }

  showPose(pose, isTracking, building) {
    const sigma = Math.sqrt(Math.max(0, (pose.covariance[0] + pose.covariance[4]) / 2));
    this.fact('Pose', isTracking ? `${pose.x.toFixed(2)}, ${pose.y.toFixed(2)} m · ${degrees(pose.theta)} · ±${(sigma * 100).toFixed(1)} cm`
      : t`not known`, isTracking ? '' : 'bad', 'POSE');
    this.fact('Where', isTracking ? t`${where(pose, building)}, sure to ${Math.max(1, Math.round(sigma * 200))} cm` : t`not known yet`,
      isTracking ? '' : 'bad', 'POSE');
    this.fact('Why', pose.reason || '–', '', 'POSE');
    this.fact('Last lamp', t`${metres(pose.distance_since_fixture)} ago`, '', 'POSE');
    this.charts.sigma.add(isTracking ? sigma * 100 : NaN);
    this.charts.nis.add(isTracking && pose.nis !== null ? pose.nis : NaN);
  }

  showGoal(navigation, building) {
    const target = navigation.target ? `${spot(navigation.target, building)}: ` : '';
    const stop = navigation.pose_count > 1 ? t`, stop ${navigation.pose_index + 1} of ${navigation.pose_count}` : '';
    this.fact('Goal', `${target}${said(NAVIGATION, navigation.state)}${stop}`, '', 'NAVIGATION_STATUS');
    setText($('pause'), navigation.state === 11 ? t`Go on` : t`Pause`);
  }

  showControl(control) {
    this.fact('Motion', `${said(CONTROL, control.state)} · ${control.linear.toFixed(2)} m/s · ${degrees(control.angular)}/s`, '',
      'CONTROL_STATUS');
    this.fact('Room ahead', control.clearance >= 10 ? t`nothing near` : metres(control.clearance),
      control.clearance < 0.15 ? 'warn' : '', 'CONTROL_STATUS');
    this.fact('Controller', control.reason || '–', '', 'CONTROL_STATUS');
  }

  showRobot(robot) {
    const volts = robot.battery_voltage;
    const turning = degrees(Math.abs(robot.angular));
    this.fact('Speed', Math.abs(robot.linear) > 0.02 ? `${robot.linear.toFixed(2)} m/s` : Math.abs(robot.angular) > 0.02
      ? t`turns, ${turning}/s` : t`stands still`);
    this.fact('Battery', volts > 0 ? `${volts.toFixed(1)} V${robot.charge_state > 0 ? t`, charging` : ''}` : t`unknown`,
      volts > 0 && volts < 11.5 ? 'bad' : '');
    this.fact('Motors', robot.motors_enabled ? t`on` : t`off`, robot.motors_enabled ? 'good' : 'warn');
    this.fact('Stop', robot.stop_button ? t`button pressed` : robot.stop_engaged ? robot.reason || t`engaged` : t`released`,
      robot.stop_button || robot.stop_engaged ? 'bad' : '');
    if (robot.stall || robot.bumpers_front || robot.bumpers_rear) {
      this.fact('Contact', robot.stall ? t`a wheel is blocked` : t`a bumper is pressed`, 'bad');
    } else this.fact('Contact', t`none`);
    this.charts.speed.add(robot.linear);
  }

  showTruth({truth, pose, ages}, isTracking) {
    if (!truth || ages.SIM_TRUTH >= STALE_S) return;
    const error = isTracking ? Math.hypot(truth.x - pose.x, truth.y - pose.y) : NaN;
    this.fact('Truth', t`${isTracking ? t`${(error * 100).toFixed(1)} cm off` : t`simulated`} · ${truth.contacts} contacts`,
      error > 0.5 || truth.touching ? 'bad' : '');
    this.charts.error.add(error * 100);
  }

  // How far behind the robot's clock its picture and its pose arrive.
  showDelays({delays}) {
    const said = [['FIXTURE_DETECTIONS', t`picture`], ['POSE', t`pose`], ['SONAR', t`sonar`]]
      .filter(([channel]) => delays[channel] !== undefined)
      .map(([channel, word]) => `${word} ${Math.max(0, Math.round(1000 * delays[channel]))} ms`);
    if (said.length) this.fact('Delay', said.join(' · '));
  }

  drawCharts(colours) {
    for (const chart of Object.values(this.charts)) chart.draw(colours.tracking, colours.faint);
  }
}

// In words where there is a place near, else by coordinates.
function where({x, y}, building) {
  const near = building?.places.map((place) => [Math.hypot(place.x - x, place.y - y), place.name]).sort((a, b) => a[0] - b[0])[0];
  if (!near || near[0] > 3) return `${x.toFixed(1)}, ${y.toFixed(1)} m`;
  return near[0] < 0.3 ? t`at ${near[1]}` : t`${near[0].toFixed(1)} m from ${near[1]}`;
}

const notes = new Map();

// A line over the map; one per subject, gone after a while.
export function note(subject, text, tone = '', seconds = 6) {
  let line = notes.get(subject);
  if (!line) {
    line = document.createElement('div');
    $('notes').append(line);
    notes.set(subject, line);
  }
  clearTimeout(line.timer);
  line.className = tone;
  setText(line, text);
  line.timer = setTimeout(() => { line.remove(); notes.delete(subject); }, seconds * 1000);
}
