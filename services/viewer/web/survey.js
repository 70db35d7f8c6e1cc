// A survey: the map that grows while somebody drives, in place of the building's own.
import * as commands from './commands.js';
import {drawCovariance, drawPlaces, drawTrail, fixture, isInView} from './layers.js';
import {SURVEY_STATES, metres} from './names.js';
import {t, translated} from './texts.js';

const $ = (id) => document.getElementById(id);
const SILENT_S = 4;   // it speaks once a second
const MARGIN_M = 2;

// What odometry went since, behind a pose.
export function carried([x, y, theta], then, now) {
  const [c, s] = [Math.cos(then.theta), Math.sin(then.theta)];
  const [u, v] = [now.x - then.x, now.y - then.y];
  const [ahead, aside] = [c * u + s * v, c * v - s * u];
  return [x + Math.cos(theta) * ahead - Math.sin(theta) * aside, y + Math.sin(theta) * ahead + Math.cos(theta) * aside,
    theta + now.theta - then.theta];
}

export class Survey {
  // `ask(subject, send, what)` sends a request and reports.
  constructor(ask) {
    Object.assign(this, {map: null, isOn: false, then: null, odometry: null});
    $('survey-place').addEventListener('submit', (event) => {
      event.preventDefault();
      const name = $('survey-name').value.trim();
      if (!name) return;
      ask('survey', () => commands.survey({action: 'place', name}), t`here is ${name}`);
      $('survey-name').value = '';
    });
    $('survey-explore').addEventListener('click', () => (this.map?.exploring
      ? ask('survey', () => commands.survey({action: 'stay'}), t`stop exploring`)
      : ask('survey', () => commands.survey({action: 'explore'}), t`explore`)));
    $('survey-finish').addEventListener('click', () => ask('survey', () => commands.survey({action: 'finish'}), t`finish`));
  }

  show(map) {
    this.map = map;
    this.then = this.odometry;
    const {state, fixtures, distance, remarks, reason, folder, exploring, activity} = map;
    const isOver = state === 'finished';
    $('survey-card').hidden = false;
    $('survey-card').dataset.state = state;
    $('survey-state').textContent = translated(SURVEY_STATES[state] ?? state);
    $('survey-reason').textContent = isOver ? t`It lies in ${folder}. All that drives the robot begins anew with it; then send it to a place.` : reason;
    const open = fixtures.filter((one) => one.open).length;
    $('survey-figures').textContent = t`${metres(distance)} driven · ${fixtures.length} lamps`;
    $('survey-open').textContent = open ? t`${open} of them to be passed once more` : '';
    $('survey-activity').textContent = activity;
    $('survey-explore').textContent = exploring ? t`Stop exploring` : t`Explore`;
    $('survey-place').hidden = $('survey-finish').hidden = $('survey-explore').hidden = isOver;
    $('survey-finish').disabled = $('survey-explore').disabled = state === 'writing';
    const lines = JSON.stringify(remarks);
    if (lines === this.lines) return;
    this.lines = lines;
    $('survey-remarks').replaceChildren(...remarks.map((text) => Object.assign(document.createElement('li'), {textContent: text})));
  }

  // It is shown on when the robot is switched off, until a localizer speaks: that one knows the building's own map.
  watch({ages, odometry}) {
    const age = ages.SURVEY_STATUS;
    this.odometry = odometry;
    this.isOn = this.map !== null && (age < SILENT_S || !(ages.POSE < SILENT_S));
    $('survey-word').textContent = this.map && age > SILENT_S ? t`silent for ${Math.round(age)} s` : '';
    document.body.classList.toggle('surveying', this.isOn);
  }

  // Where the robot is: the survey says it once a second, odometry more often.
  pose() {
    const {map, then, odometry} = this;
    if (!map?.pose) return null;
    return then && odometry ? carried(map.pose, then, odometry) : map.pose;
  }

  bounds() {
    if (!this.isOn) return null;
    const points = [...this.map.path, ...this.map.fixtures.map(({pose}) => pose)];
    if (points.length < 2) return [-5, -5, 5, 5];
    const [xs, ys] = [points.map(([x]) => x), points.map(([, y]) => y)];
    return [Math.min(...xs) - MARGIN_M, Math.min(...ys) - MARGIN_M, Math.max(...xs) + MARGIN_M, Math.max(...ys) + MARGIN_M];
  }

  draw(context, view, colours) {
    drawTrail(context, view, this.map.path, colours.trail);
    for (const lamp of this.map.fixtures) {
      if (!isInView(view, lamp.pose, lamp.length)) continue;
      const [xx, xy, yy] = lamp.covariance;
      fixture(context, view, lamp);
      context.globalAlpha = lamp.provisional ? 0.35 : 1;
      context.fillStyle = colours.fixtureSeen;
      context.fill();
      context.globalAlpha = 1;
      context.lineWidth = lamp.open ? 3 : 1.5;
      context.strokeStyle = lamp.open ? colours.lost : colours.fixtureEdge;
      context.setLineDash(lamp.provisional ? [4, 3] : []);
      context.stroke();
      context.setLineDash([]);
      if (xx > 0) drawCovariance(context, view, lamp.pose, [xx, xy, 0, 0, yy], lamp.open ? colours.lost : colours.tracking);
    }
    drawPlaces(context, view, this.map, colours);
  }
}
