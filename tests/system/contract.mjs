// contract.mjs PACKAGES ADDRESS TOKEN: what a running viewer serves is what /api/openapi.json says, and the other way round:
// each value that is served is described, and each value that is described was served. Ends with commands that change things.
import {createRequire} from 'node:module';
import {setTimeout as sleep} from 'node:timers/promises';

const [folder, address, token] = process.argv.slice(2);
const require = createRequire(`${folder}/`);
const Ajv = require('ajv/dist/2020').default;
const {Validator} = await import(require.resolve('@seriousme/openapi-schema-validator'));

// the laboratory has no zones, and no stored tours
const NOT_HERE = new Set([...['name', 'kind', 'polygon', 'speed', 'direction', 'hours', 'days', 'in_force'].map((key) => `Zone.${key}`),
  ...['name', 'at', 'days', 'stops'].map((key) => `Tour.${key}`), ...['place', 'pause', 'text', 'photo'].map((key) => `TourStop.${key}`)]);
const EDITED = ['/api/building', '/api/tours'];

// Only where a log is shown; tests/browser/playback_test.mjs compares it there.
const OF_LOGS = new Set(['/api/playback', 'playback', 'Playback', 'PlaybackState', 'PlaybackRequest']);
// Likewise what only a survey serves: tests/browser/survey_test.mjs.
const ELSEWHERE = new Set([...OF_LOGS, '/api/survey', 'survey', 'Survey', 'SurveyedFixture', 'NamedPoint']);

const description = await (await fetch(`${address}/api/openapi.json`)).json();
const schemas = description.components.schemas;
const failures = [];
const seen = new Set();  // "Schema.property"

const check = await new Validator().validate(structuredClone(description));
if (!check.valid) failures.push(`no OpenAPI 3.1: ${JSON.stringify(check.errors).slice(0, 500)}`);
const ajv = new Ajv({allErrors: true, strict: false, validateFormats: false});
ajv.addSchema(description, 'api');
const name = (reference) => reference.split('/').pop();

// Remembers which properties of which named schema a value has.
function visit(schema, value, owner) {
  if (schema.$ref) [owner, schema] = [name(schema.$ref), schemas[name(schema.$ref)]];
  for (const option of schema.oneOf ?? []) if (value !== null) visit(option, value, owner);
  if (Array.isArray(value)) for (const item of value) visit(schema.items ?? {}, item, owner);
  else if (value && typeof value === 'object') {
    for (const [key, inner] of Object.entries(schema.properties ?? {})) {
      if (!(key in value)) continue;
      seen.add(`${owner}.${key}`);
      visit(inner, value[key], `${owner}.${key}`);
    }
  }
}
// All properties that a schema describes, by the same names.
function described(schema, owner) {
  if (schema.$ref) return [];  // visited by its own name
  const inner = [...(schema.oneOf ?? []), ...(schema.items ? [schema.items] : [])].flatMap((part) => described(part, owner));
  return Object.entries(schema.properties ?? {}).flatMap(([key, part]) =>
    [`${owner}.${key}`, ...described(part, `${owner}.${key}`)]).concat(inner);
}

function expect(schema, value, what) {
  const valid = ajv.getSchema(`api#/components/schemas/${name(schema.$ref)}`);
  if (!valid(value)) failures.push(`${what}: ${ajv.errorsText(valid.errors).slice(0, 300)}`);
  visit(schema, value, '');
}

async function readAll() {
  for (const [path, {get}] of Object.entries(description.paths)) {
    const schema = get?.responses[200].content['application/json']?.schema;
    if (!schema?.$ref || ELSEWHERE.has(path)) continue;
    const answer = await fetch(address + path);
    if (answer.ok) expect(schema, await answer.json(), path);
    else failures.push(`${path}: ${answer.status}`);
  }
}

// Listens until each kind of event came.
async function listen() {
  const kinds = description.paths['/events'].get['x-events'];
  const missing = new Set(Object.keys(kinds).filter((kind) => !ELSEWHERE.has(kind)));
  const answer = await fetch(`${address}/events`, {signal: AbortSignal.timeout(20_000)});
  let text = '';
  for await (const piece of answer.body.pipeThrough(new TextDecoderStream())) {
    text += piece;
    for (let end = text.indexOf('\n\n'); end >= 0; end = text.indexOf('\n\n')) {
      const [, kind, data] = /event: (\w+)\ndata: (.*)/.exec(text.slice(0, end)) ?? [];
      text = text.slice(end + 2);
      if (kind && !kinds[kind]) failures.push(`the event ${kind} is not described`);
      else if (kind) expect(kinds[kind], JSON.parse(data), `event ${kind}`);
      missing.delete(kind);
    }
    if (missing.size === 0) return;
  }
}

const post = (path, body, withToken = true) => fetch(address + path, {method: 'POST', body: JSON.stringify(body),
  headers: {'Content-Type': 'application/json', ...(withToken ? {'X-Luminav-Token': token} : {})}});

async function expectStatus(path, body, status, why) {
  const answer = await post(path, body);
  const said = await answer.json();
  if (answer.status !== status) failures.push(`POST ${path} ${why} ${JSON.stringify(body)}: ${answer.status} ${JSON.stringify(said)}`);
  expect({$ref: answer.ok ? description.paths[path].post.responses[200].content['application/json'].schema.$ref
    : '#/components/schemas/Error'}, said, `answer of ${path}`);
}

// Each example is taken; with a strange key, without a needed one or with a wrong type it is not.
async function command(path, {post: operation}) {
  const {schema, examples} = operation.requestBody.content['application/json'];
  const {required, additionalProperties} = schemas[name(schema.$ref)];
  for (const {value} of Object.values(examples)) {
    const body = 'seen' in value ? {...value, seen: (await (await fetch(`${address}/api/state`)).json()).utime} : value;
    expect(schema, body, `example of ${path}`);
    await expectStatus(path, body, EDITED.includes(path) ? 409 : 200, 'example');  // of no such version
    if (additionalProperties !== false) continue;
    await expectStatus(path, {...body, strange: 1}, 400, 'with a strange key');
    for (const key of required) {
      const {[key]: left, ...rest} = body;
      await expectStatus(path, rest, 400, `without ${key}`);
      await expectStatus(path, {...body, [key]: {}}, 400, `with a wrong ${key}`);
    }
  }
  if (path !== '/api/stop' && (await post(path, Object.values(examples)[0].value, false)).status !== 403) {
    failures.push(`${path} is taken without the token`);
  }
}

const metrics = await (await fetch(`${address}/metrics`)).text();
const LINE = /^(# (HELP|TYPE) luminav_\w+ .+|luminav_\w+(\{(\w+="[^"]*",?)+\})? -?[\d.]+(e[-+]\d+)?)$/;
for (const line of metrics.trimEnd().split('\n')) if (!LINE.test(line)) failures.push(`/metrics: ${line}`);
for (const wanted of ['process_cpu_fraction', 'process_memory_bytes', 'process_restarts_total', 'process_lost_inputs_total',
  'process_worst_step_seconds', 'battery_volts', 'distance_meters_total', 'goals_total', 'contacts_total', 'seconds_since_fixture']) {
  if (!metrics.includes(`\nluminav_${wanted}`)) failures.push(`/metrics has no luminav_${wanted}`);
}
if ((await post('/api/playback', {playing: true})).status !== 404) failures.push('a running robot is played back');
await post('/api/stop', {engaged: false});
await post('/api/goal', {action: 'go', poses: [{place: 'workbench'}]});
for (let tries = 0; tries < 100 && (await (await fetch(`${address}/api/state`)).json()).navigation?.target === undefined; ++tries) await sleep(100);
for (let round = 0; round < 20; ++round) {
  await readAll();
  await sleep(100);
}
await listen();
for (const [path, operations] of Object.entries(description.paths)) if (operations.post?.requestBody && !OF_LOGS.has(path)) await command(path, operations);
for (const path of EDITED) {
  const {version} = await (await fetch(address + path)).json();
  await expectStatus(path, {version, action: 'undo'}, 200, 'with nothing to undo');
}
await expectStatus('/api/watch', {}, 200, 'at last');
const order = async () => (await (await fetch(`${address}/api/processes`)).json()).order;
for (let tries = 0; tries < 100 && !await order(); ++tries) await sleep(100);
for (const path of EDITED) {
  const undone = async () => (await (await fetch(address + path)).json()).orders.length > 0;
  for (let tries = 0; tries < 100 && !await undone(); ++tries) await sleep(100);
}
await readAll();
for (const owner of Object.keys(schemas).filter((name) => !ELSEWHERE.has(name))) {
  for (const property of new Set(described(schemas[owner], owner))) {
    if (!seen.has(property) && !NOT_HERE.has(property)) failures.push(`${property} is described but was never served`);
  }
}
console.log(failures.length ? [...new Set(failures)].join('\n') : `${seen.size} values of ${Object.keys(schemas).length} schemas agree`);
process.exit(failures.length ? 1 : 0);
