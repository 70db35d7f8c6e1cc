// Words for the numbers of lcmtypes.
import {t, translated} from './texts.js';

export const POSE = ['LOST', 'AMBIGUOUS', 'TRACKING'];
export const NAVIGATION = ['idle', 'localizing', 'planning', 'following', 'waiting', 'arrived', 'no path', 'blocked', 'stuck',
  'cancelled', 'lost', 'paused'];
export const CONTROL = ['idle', 'wandering', 'following', 'turning', 'at goal', 'yielding', 'escaping', 'stuck', 'stopped',
  'teleoperated'];
export const NODE = ['starting', 'ready', 'degraded', 'fault'];
// What a page asks for.
export const SUBJECTS = ['survey', 'goal', 'go', 'stop', 'motors', 'initial pose', 'map', 'route', 'cancel', 'pause', 'resume', 'release', 'record',
  'process', 'pose', 'log', 'delete', 'job'];
export const SURVEY_STATES = {driving: 'Drive on: the map grows behind the robot.', estimating: 'Drive on: the map is being estimated anew.',
  writing: 'The map is being written …', finished: 'Finished.', failed: 'This went wrong:'};
export const JOB_KINDS = {go: 'Drive', guide: 'Guide me', carry: 'Carry something', tour: 'Tour', home: 'Drive home'};
// What people say to a job.
export const JOB_WORDS = ['loaded', 'unloaded', 'here', 'wait', 'opened', 'go round', 'try again', 'go on', 'leave out', 'charging', 'give up'];
export const ZONE_KINDS = {'keep-out': 'never enter', slow: 'drive slowly', 'one-way': 'one way only', quiet: 'no wandering'};
// As a jobs file has them.
export const DAYS = ['Mo', 'Tu', 'We', 'Th', 'Fr', 'Sa', 'Su'];
// "Mo-Fr 08:00-12:00"; "" = always.
export const hoursOf = ({days, hours}) => [days, hours].filter(Boolean).join(' ');
export const ACTIONS = ['start', 'stop', 'restart'];
export const CONDITIONS = ['stopped', 'starting', 'ready', 'degraded', 'fault', 'silent', 'stopping', 'restarting', 'failed', 'gave up', 'refused', 'unknown'];
// Facts about the robot: for everybody, and what only experts want to know.
export const EVERYBODY = ['Where', 'Goal', 'Speed', 'Room ahead', 'Battery', 'Motors', 'Stop', 'Contact'];
export const EXPERTS = ['Pose', 'Why', 'Motion', 'Controller', 'Last lamp', 'Delay', 'Truth'];
export const LIGHT = ['unknown', 'lit', 'unlit', 'half lit'];

// English, for comparing; `said` is for reading.
export const nameOf = (names, state) => names[state] ?? `state ${state}`;
export const said = (names, state) => translated(nameOf(names, state));
export const degrees = (radians) => `${Math.round(radians * 180 / Math.PI)}°`;
export const metres = (value) => `${value.toFixed(value < 10 ? 2 : 1)} m`;

// The place of the building at a point, or the point.
export function spot(point, building) {
  const place = building?.places.find((p) => Math.hypot(p.x - point[0], p.y - point[1]) < 0.3);
  return place ? place.name : `(${point[0].toFixed(1)}, ${point[1].toFixed(1)})`;
}

const SILENT_S = 2;       // [s] of what comes several times a second
const PLANNER_S = 4;      // [s] the planner speaks less often

// What the robot has to do without, as a sentence behind the other; '' while all is there.
function missing({ages}) {
  const lacks = [['CAMERA_IMAGE', t`no picture from its camera`], ['FIXTURE_DETECTIONS', t`no word from its detector`], ['SONAR', t`no sonar`]]
    .filter(([channel]) => ages[channel] > SILENT_S);
  return lacks.length ? t` It has had ${lacks[0][1]} for ${Math.round(ages[lacks[0][0]])} s.` : '';
}

// One sentence: what the robot does, or why not.
export function sentence(state, building) {
  const {robot, control, navigation, ages} = state;
  if (robot?.connected && control && ages.CONTROL_STATUS > SILENT_S) {
    return t`The controller has been silent for ${Math.round(ages.CONTROL_STATUS)} s: the robot stands.`;
  }
  if (robot?.connected && navigation && ages.NAVIGATION_STATUS > PLANNER_S && !robot.stop_engaged) {
    return t`The planner has been silent for ${Math.round(ages.NAVIGATION_STATUS)} s.` + missing(state);
  }
  return doing(state, building) + missing(state);
}

function doing(state, building) {
  const {robot, control, navigation, pose} = state;
  if (robot && !robot.connected) return t`The robot is not connected. ${robot.reason}`;
  if (robot?.stop_button) return t`The stop button on the robot is pressed.`;
  if (robot?.stop_engaged || control?.stop_engaged) return t`Stopped: it stands still until the stop is released.`;
  if (robot && !robot.motors_enabled) return t`The motors are off.`;
  if (nameOf(CONTROL, control?.state) === 'teleoperated') return t`Is driven by hand.`;
  if (nameOf(CONTROL, control?.state) === 'stopped' && control.reason) return t`Stands still: ${control.reason}.`;
  if (!navigation) return pose ? t`No word from the planner.` : t`Waiting for the robot …`;
  const to = navigation.target ? t` to ${spot(navigation.target, building)}` : '';
  const left = navigation.distance_left > 0 ? t`, ${navigation.distance_left.toFixed(1)} m left` : '';
  const why = navigation.cause ? `: ${navigation.cause}` : '';
  switch (nameOf(NAVIGATION, navigation.state)) {
    case 'idle': return t`Stands still and waits for a goal.`;
    case 'localizing': return t`Looks for where it is${why || t`, wandering slowly`}.`;
    case 'planning': return t`Plans the way${to}.`;
    case 'following': {
      const doing = {yielding: t`Waits for somebody to pass on the way`, escaping: t`Frees itself on the way`,
        turning: t`Turns on the way`}[nameOf(CONTROL, control?.state)] ?? t`Drives`;
      return `${doing}${to}${left}${control?.reason ? `: ${control.reason}` : ''}.`;
    }
    case 'waiting': return t`Waits${to}${why}.`;
    case 'arrived': return t`Arrived${navigation.target ? t` at ${spot(navigation.target, building)}` : ''}.`;
    case 'no path': return t`Finds no way${to}${why}.`;
    case 'blocked': return t`The way${to} is blocked${why}.`;
    case 'stuck': return t`Is stuck on the way${to}${why}.`;
    case 'cancelled': return t`The goal was cancelled.`;
    case 'lost': return t`Lost its way${to}${why}.`;
    case 'paused': return why.endsWith('?') ? t`Pauses${why}` : t`Pauses on the way${to}.`;
    default: return navigation.cause;
  }
}
