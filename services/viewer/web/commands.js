import {t} from './texts.js';

// What moves the robot. Commands have a port of their own, where nobody waits in line behind a slow page; the page's port
// takes them too, for instance through a tunnel that forwards only that one.
const token = (() => {
  const given = new URLSearchParams(location.hash.slice(1)).get('token');
  if (given) {
    sessionStorage.setItem('token', given);
    globalThis.history?.replaceState(null, '', location.pathname + location.search);  // not for whoever looks over a shoulder
  }
  return given ?? sessionStorage.getItem('token') ?? '';
})();

let commandBase = '';     // '' = the page's port
let hasAnswered = false;  // the port of its own: then one slow answer is no reason to leave it
export const ownToken = token;
export const settings = fetch('settings.json').then((answer) => answer.json()).then((said) => {
  commandBase = `${location.protocol}//${location.hostname}:${said.command_port}`;
  // What a page shows and listens to has no headers; the viewer heeds the cookie for that alone.
  if (said.needs_token_to_look && token) document.cookie = `luminav_token=${token}; path=/; SameSite=Strict`;
  return said;
}).catch(() => ({}));

// What this page may: "anybody", "look", "drive" or "administer".
export const ownRole = () => fetch('settings.json', {headers: token ? {'X-Luminav-Token': token} : {}}).then((answer) => answer.json());

async function post(base, name, body, {type = 'application/json', patience = 3000, withToken = true} = {}) {
  const headers = {'Content-Type': type};
  if (token && withToken) headers['X-Luminav-Token'] = token;
  const answer = await fetch(`${base}/api/${name}`,
    {method: 'POST', headers, body: JSON.stringify(body), signal: AbortSignal.timeout(patience)}).catch((error) => {
    throw new Error(error.name === 'TimeoutError' ? t`the viewer does not answer` : t`no connection to the viewer`);
  });
  const said = await answer.json().catch(() => ({}));
  if (!answer.ok) throw Object.assign(new Error(said.error ?? t`the viewer answers ${answer.status}`), {refused: true, status: answer.status});
  return said;
}
const send = async (...what) => (await post(...what)).id;

// One way only: a port of its own that cannot be reached is not tried again.
async function sendOnce(name, body, patience) {
  const base = commandBase;
  try {
    const id = await send(base, name, body, {patience});
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
    return send('', name, body);
  }
}

// `skips`: a stop that cannot be reached is left out instead of ending the goal.
export const go = (poses, loop = false, skips = loop) => command('goal', {action: 'go', poses, loop, policy: skips ? 'skip' : 'stop'});
export const goal = (action) => command('goal', {action});
export const motorsOn = () => command('motors', {enable: true});
export const initialPose = (x, y, theta) => command('initial_pose', {x, y, theta});
export const map = (action) => command('map', {action});
export const job = (body) => command('jobs', body);
export const survey = (body) => command('survey', body);
export const building = (order) => command('building', order);
export const tours = (order) => command('tours', order);
export const remove = (kind, name) => command('files', {action: 'delete', kind, name});
export const playback = (order) => command('playback', order);
export const process = (name, action) => command('process', {name, action});
// Not a second time, and not for long: what comes late is worth nothing.
export const steer = (steering) => sendOnce('steering', steering, 500);
export const release = () => command('stop', {engaged: false});

// Both ways at once, as plain text and without the token, for which browsers ask no permission first: the quickest there
// is, and it needs no token.
const PLAIN = {type: 'text/plain', withToken: false, patience: 1500};
function bothWays(name, body, onPage = PLAIN) {
  const ways = [post('', name, body, onPage)];
  if (commandBase) ways.push(post(commandBase, name, body, PLAIN));
  return ways;
}
export function stop() {
  return Promise.any(bothWays('stop', {engaged: true})).catch((all) => { throw all.errors[0]; });
}

// Whether a stop would get through, by the same ways; returns whether anything else would be obeyed. To the robot it is the
// sign that somebody watches.
export async function watch() {
  const ways = bothWays('watch', {}, {...PLAIN, withToken: true});
  await Promise.any(ways).catch((all) => { throw all.errors[0]; });
  return ways[0].then((said) => said.may_command !== false, () => true);
}
