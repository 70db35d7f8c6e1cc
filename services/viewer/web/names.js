// Words for the numbers of lcmtypes.
export const POSE = ['LOST', 'AMBIGUOUS', 'TRACKING'];
export const NAVIGATION = ['idle', 'localizing', 'planning', 'following', 'waiting', 'arrived', 'no path', 'blocked', 'stuck',
  'cancelled', 'lost', 'paused'];
export const CONTROL = ['idle', 'wandering', 'following', 'turning', 'at goal', 'yielding', 'escaping', 'stuck', 'stopped',
  'teleoperated'];
export const NODE = ['starting', 'ready', 'degraded', 'fault'];
export const LIGHT = ['unknown', 'lit', 'unlit', 'half lit'];

export const nameOf = (names, state) => names[state] ?? `state ${state}`;
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
  const lacks = [['CAMERA_IMAGE', 'no picture from its camera'], ['FIXTURE_DETECTIONS', 'no word from its detector'], ['SONAR', 'no sonar']]
    .filter(([channel]) => ages[channel] > SILENT_S);
  return lacks.length ? ` It has had ${lacks[0][1]} for ${Math.round(ages[lacks[0][0]])} s.` : '';
}

// One sentence: what the robot does, or why not.
export function sentence(state, building) {
  const {robot, control, navigation, ages} = state;
  if (robot?.connected && control && ages.CONTROL_STATUS > SILENT_S) {
    return `The controller has been silent for ${Math.round(ages.CONTROL_STATUS)} s: the robot stands.`;
  }
  if (robot?.connected && navigation && ages.NAVIGATION_STATUS > PLANNER_S && !robot.stop_engaged) {
    return `The planner has been silent for ${Math.round(ages.NAVIGATION_STATUS)} s.${missing(state)}`;
  }
  return doing(state, building) + missing(state);
}

function doing(state, building) {
  const {robot, control, navigation, pose} = state;
  if (robot && !robot.connected) return `The robot is not connected. ${robot.reason}`;
  if (robot?.stop_button) return 'The stop button on the robot is pressed.';
  if (robot?.stop_engaged || control?.stop_engaged) return 'Stopped: it stands still until the stop is released.';
  if (robot && !robot.motors_enabled) return 'The motors are off.';
  if (nameOf(CONTROL, control?.state) === 'teleoperated') return 'Is driven by hand.';
  if (nameOf(CONTROL, control?.state) === 'stopped' && control.reason) return `Stands still: ${control.reason}.`;
  if (!navigation) return pose ? 'No word from the planner.' : 'Waiting for the robot …';
  const to = navigation.target ? ` to ${spot(navigation.target, building)}` : '';
  const left = navigation.distance_left > 0 ? `, ${navigation.distance_left.toFixed(1)} m left` : '';
  const why = navigation.cause ? `: ${navigation.cause}` : '';
  switch (nameOf(NAVIGATION, navigation.state)) {
    case 'idle': return 'Stands still and waits for a goal.';
    case 'localizing': return `Looks for where it is${why || ', wandering slowly'}.`;
    case 'planning': return `Plans the way${to}.`;
    case 'following': {
      const doing = {yielding: 'Waits for somebody to pass on the way', escaping: 'Frees itself on the way',
        turning: 'Turns on the way'}[nameOf(CONTROL, control?.state)] ?? 'Drives';
      return `${doing}${to}${left}${control?.reason ? `: ${control.reason}` : ''}.`;
    }
    case 'waiting': return `Waits${to}${why}.`;
    case 'arrived': return `Arrived${navigation.target ? ` at ${spot(navigation.target, building)}` : ''}.`;
    case 'no path': return `Finds no way${to}${why}.`;
    case 'blocked': return `The way${to} is blocked${why}.`;
    case 'stuck': return `Is stuck on the way${to}${why}.`;
    case 'cancelled': return 'The goal was cancelled.';
    case 'lost': return `Lost its way${to}${why}.`;
    case 'paused': return why.endsWith('?') ? `Pauses${why}` : `Pauses on the way${to}.`;
    default: return navigation.cause;
  }
}
