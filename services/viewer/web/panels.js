// Words and figures beside the map.
import {Chart} from './charts.js';
import {guarded} from './guard.js';
import {CONTROL, NAVIGATION, POSE, degrees, metres, nameOf, sentence} from './names.js';

const $ = (id) => document.getElementById(id);
const STALE_S = 1.0;  // the slowest of the channels that must not stop comes at 10 Hz

const FACTS = ['Pose', 'Why', 'Goal', 'Motion', 'Controller', 'Free space', 'Last fixture', 'Battery', 'Motors', 'Stop', 'Contact',
  'Delay', 'Truth'];

function setText(element, text) { if (element.textContent !== text) element.textContent = text; }

export class Panels {
  constructor() {
    this.charts = {
      sigma: new Chart($('charts'), 'position ±', 'cm', 1, 5),
      speed: new Chart($('charts'), 'speed', 'm/s', 2, 0.5),
      nis: new Chart($('charts'), 'innovation²', '', 2, 2),
      error: new Chart($('charts'), 'true error', 'cm', 1, 5),
    };
    this.charts.error.hide();
    this.facts = new Map();
    for (const name of FACTS) {  // their order is fixed, whoever speaks first
      const entry = {term: document.createElement('dt'), value: document.createElement('dd')};
      entry.term.textContent = name;
      entry.term.hidden = entry.value.hidden = true;
      $('facts').append(entry.term, entry.value);
      this.facts.set(name, entry);
    }
  }

  fact(name, value, tone = '') {
    const entry = this.facts.get(name);
    entry.term.hidden = entry.value.hidden = false;
    setText(entry.value, value);
    entry.value.className = tone;
  }

  // What a person must know at one look; a word that stopped coming is not shown as if it still held.
  show(state, building) {
    const {pose, robot, control, navigation, ages} = state;
    const poseIsOld = !pose || ages.POSE > STALE_S;
    const isTracking = !poseIsOld && pose.state === 2;
    guarded('the headline', () => {
      const badge = $('pose-state');
      setText(badge, poseIsOld ? 'no pose' : nameOf(POSE, pose.state));
      badge.dataset.state = poseIsOld ? 'none' : nameOf(POSE, pose.state).toLowerCase();
      setText($('doing'), ages.ROBOT_STATUS > STALE_S ? 'No word from the robot.' : sentence(state, building));
    });
    if (pose) guarded('the pose', () => this.showPose(pose, isTracking));
    if (navigation) guarded('the goal', () => this.showGoal(navigation));
    if (control) guarded('the motion', () => this.showControl(control));
    if (robot) guarded('the robot', () => this.showRobot(robot));
    guarded('the truth', () => this.showTruth(state, isTracking));
    $('motors').hidden = !robot || robot.motors_enabled || !robot.connected;
  }

  showPose(pose, isTracking) {
    const sigma = Math.sqrt(Math.max(0, (pose.covariance[0] + pose.covariance[4]) / 2));
    this.fact('Pose', isTracking ? `${pose.x.toFixed(2)}, ${pose.y.toFixed(2)} m · ${degrees(pose.theta)} · ±${(sigma * 100).toFixed(1)} cm`
      : 'not known', isTracking ? '' : 'bad');
    this.fact('Why', pose.reason || '–');
    this.fact('Last fixture', `${metres(pose.distance_since_fixture)} ago`);
    this.charts.sigma.add(isTracking ? sigma * 100 : NaN);
    this.charts.nis.add(isTracking && pose.nis !== null ? pose.nis : NaN);
  }

  showGoal(navigation) {
    this.fact('Goal', navigation.pose_count > 1
      ? `${nameOf(NAVIGATION, navigation.state)}, stop ${navigation.pose_index + 1} of ${navigation.pose_count}`
      : nameOf(NAVIGATION, navigation.state));
    setText($('pause'), navigation.state === 11 ? 'Go on' : 'Pause');
  }

  showControl(control) {
    this.fact('Motion', `${nameOf(CONTROL, control.state)} · ${control.linear.toFixed(2)} m/s · ${degrees(control.angular)}/s`);
    this.fact('Free space', control.clearance >= 10 ? 'nothing near' : metres(control.clearance),
      control.clearance < 0.15 ? 'warn' : '');
    this.fact('Controller', control.reason || '–');
  }

  showRobot(robot) {
    const volts = robot.battery_voltage;
    this.fact('Battery', volts > 0 ? `${volts.toFixed(1)} V${robot.charge_state > 0 ? ', charging' : ''}` : 'unknown',
      volts > 0 && volts < 11.5 ? 'bad' : '');
    this.fact('Motors', robot.motors_enabled ? 'on' : 'off', robot.motors_enabled ? 'good' : 'warn');
    this.fact('Stop', robot.stop_button ? 'button pressed' : robot.stop_engaged ? robot.reason || 'engaged' : 'released',
      robot.stop_button || robot.stop_engaged ? 'bad' : '');
    if (robot.stall || robot.bumpers_front || robot.bumpers_rear) {
      this.fact('Contact', robot.stall ? 'a wheel is blocked' : 'a bumper is pressed', 'bad');
    } else this.fact('Contact', 'none');
    this.charts.speed.add(robot.linear);
  }

  showTruth({truth, pose, ages}, isTracking) {
    if (!truth || ages.SIM_TRUTH >= STALE_S) return;
    const error = isTracking ? Math.hypot(truth.x - pose.x, truth.y - pose.y) : NaN;
    this.fact('Truth', `${isTracking ? `${(error * 100).toFixed(1)} cm off` : 'simulated'} · ${truth.contacts} contacts`,
      error > 0.5 || truth.touching ? 'bad' : '');
    this.charts.error.add(error * 100);
  }

  // How far behind the robot's clock its picture and its pose arrive.
  showDelays({delays}) {
    const said = [['FIXTURE_DETECTIONS', 'picture'], ['POSE', 'pose'], ['SONAR', 'sonar']]
      .filter(([channel]) => delays[channel] !== undefined)
      .map(([channel, word]) => `${word} ${Math.max(0, Math.round(1000 * delays[channel]))} ms`);
    if (said.length) this.fact('Delay', said.join(' · '));
  }

  drawCharts(colours) {
    for (const chart of Object.values(this.charts)) chart.draw(colours.tracking, colours.faint);
  }
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
