// What moves the robot. Commands have a port of their own, where nobody waits in line behind a slow page; the page's port
// takes them too, for instance through a tunnel that forwards only that one.
const token = (() => {
  const given = new URLSearchParams(location.hash.slice(1)).get('token');
  if (given) sessionStorage.setItem('token', given);
  return given ?? sessionStorage.getItem('token') ?? '';
})();

let commandBase = '';     // '' = the page's port
let hasAnswered = false;  // the port of its own: then one slow answer is no reason to leave it
fetch('settings.json').then((answer) => answer.json()).then((settings) => {
  commandBase = `${location.protocol}//${location.hostname}:${settings.command_port}`;
}).catch(() => {});

async function send(base, name, body, type, patience = 3000) {
  const headers = {'Content-Type': type};
  if (token) headers['X-Luminav-Token'] = token;
  const answer = await fetch(`${base}/api/${name}`,
    {method: 'POST', headers, body: JSON.stringify(body), signal: AbortSignal.timeout(patience)});
  const said = await answer.json().catch(() => ({}));
  if (!answer.ok) throw Object.assign(new Error(said.error ?? `the viewer answers ${answer.status}`), {refused: true});
  return said.id;
}

// One way only: a port of its own that cannot be reached is not tried again.
async function sendOnce(name, body, patience) {
  const base = commandBase;
  try {
    const id = await send(base, name, body, 'application/json', patience);
    hasAnswered ||= base !== '';
    return id;
  } catch (error) {
    hasAnswered ||= base !== '' && error.refused === true;
    if (!hasAnswered) commandBase = '';
    throw error;
  }
}

async function command(name, body) {
  const base = commandBase;
  try {
    return await sendOnce(name, body);
  } catch (error) {
    if (error.refused || !base) throw error;
    return send('', name, body, 'application/json');
  }
}

export const go = (poses, loop = false) => command('goal', {action: 'go', poses, loop});
export const goal = (action) => command('goal', {action});
export const motorsOn = () => command('motors', {enable: true});
export const initialPose = (x, y, theta) => command('initial_pose', {x, y, theta});
export const map = (action) => command('map', {action});
export const process = (name, action) => command('process', {name, action});
// Not a second time, and not for long: what comes late is worth nothing.
export const steer = (steering) => sendOnce('steering', steering, 500);
export const release = () => command('stop', {engaged: false});

// Both ways at once, and as plain text, for which browsers ask no permission first: the quickest there is.
export function stop() {
  const ways = [send('', 'stop', {engaged: true}, 'text/plain')];
  if (commandBase) ways.push(send(commandBase, 'stop', {engaged: true}, 'text/plain'));
  return Promise.any(ways).catch((all) => { throw all.errors[0]; });
}
