// mcap_test.mjs PACKAGES EXPORT LOG FOLDER: the reference reader reads what `export --mcap` wrote. Counts, stamps and values are
// those of the tables that `export --csv` writes of the same log; each message fits its own schema and the published one.
import {spawnSync} from 'node:child_process';
import {copyFileSync, openSync, readFileSync, rmSync, mkdirSync, statSync, truncateSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {open} from 'node:fs/promises';

const [packages, program, log, folder] = process.argv.slice(2);
const require = createRequire(`${packages}/`);
const {McapIndexedReader, McapStreamReader} = require('@mcap/core');
const Ajv = require('ajv');
const published = require('@foxglove/schemas/jsonschema.js');

const failures = [];
const expect = (holds, what) => { if (!holds && failures.length < 20) failures.push(what); };

function run(args, status = 0) {
  const done = spawnSync(program, args, {encoding: 'utf8'});
  expect(done.status === status, `export ${args.join(' ')}: exit status ${done.status}, ${done.stdout}${done.stderr}`);
  return done.stdout + done.stderr;
}

// By the index, as a viewer reads it; and from the beginning, as a pipe.
async function readIndexed(file) {
  const handle = await open(file);
  const readable = {
    size: async () => BigInt((await handle.stat()).size),
    read: async (offset, size) => {
      const bytes = new Uint8Array(Number(size));
      await handle.read(bytes, 0, Number(size), Number(offset));
      return bytes;
    }};
  const reader = await McapIndexedReader.Initialize({readable});
  const messages = [];
  for await (const message of reader.readMessages()) messages.push(message);
  await handle.close();
  return {reader, messages};
}

function countStreamed(file) {
  const reader = new McapStreamReader({validateCrcs: true});
  reader.append(readFileSync(file));
  let count = 0;
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) count += record.type === 'Message' ? 1 : 0;
  expect(reader.done(), 'the stream does not end as it should');
  return count;
}

// RFC 4180.
function table(file) {
  const rows = [[]];
  for (const [, quoted, plain, end] of readFileSync(file, 'utf8').matchAll(/(?:"((?:[^"]|"")*)"|([^,\n"]*))(,|\n)/g)) {
    rows.at(-1).push(quoted?.replaceAll('""', '"') ?? plain);
    if (end === '\n') rows.push([]);
  }
  rows.pop();
  return {heads: rows[0].map((head) => head.replace(/ \[[^\]]*\]$/, '')), rows: rows.slice(1)};
}

const at = (value, path) => path.split(/[.[\]]+/).filter(Boolean).reduce((inner, key) => inner?.[key], value);
let compared = 0;

// The channel's messages as they are, against the table, value by value.
function compare(channel, messages) {
  const {heads, rows} = table(`${folder}/csv/${channel}.csv`);
  expect(rows.length === messages.length, `${channel}: ${messages.length} messages of ${rows.length}`);
  rows.forEach((row, index) => {
    const {logTime, publishTime, json} = messages[index];
    expect(logTime === BigInt(row[0]) * 1000n, `${channel} ${index}: received ${logTime}`);
    if (json.utime > 0) expect(publishTime === BigInt(json.utime) * 1000n, `${channel} ${index}: stamp ${publishTime}`);
    heads.slice(1).forEach((head, column) => {
      const text = row[column + 1];
      if (text === '') return;  // an array that is shorter here, or an empty text
      const value = at(json, head);
      expect(typeof value === 'string' ? value === text : value === Number(text), `${channel} ${index} ${head}: ${value} is not ${text}`);
      ++compared;
    });
  });
}

function stampOf(json) {
  const {sec, nsec} = json.timestamp ?? json.transforms?.[0].timestamp ?? json.entities?.[0].timestamp ?? json.points?.[0]?.timestamp ?? {};
  return sec === undefined ? undefined : BigInt(sec) * 1_000_000_000n + BigInt(nsec);
}

// The standard topics: as many as there are messages they are made of, with their stamps, and what they hold.
function compareStandard(topics) {
  const of = (name) => topics.get(name) ?? [];
  const pairs = {'/pose': 'POSE', '/sonar': 'SONAR', '/camera': 'CAMERA_IMAGE', '/camera/fixtures': 'FIXTURE_DETECTIONS', '/path': 'PATH'};
  for (const [topic, channel] of Object.entries(pairs)) {
    expect(of(topic).length === of(channel).length, `${topic}: ${of(topic).length} of ${of(channel).length}`);
    of(topic).forEach(({json, publishTime, logTime}, i) => {
      const raw = of(channel)[i];
      expect(logTime === raw.logTime && publishTime === raw.publishTime && (stampOf(json) ?? publishTime) === publishTime, `${topic} ${i}: another stamp`);
    });
  }
  of('/pose').forEach(({json: {pose}}, i) => {
    const raw = of('POSE')[i].json;
    const theta = 2 * Math.atan2(pose.orientation.z, pose.orientation.w);
    expect(pose.position.x === raw.x && pose.position.y === raw.y && Math.abs(Math.sin((theta - raw.theta) / 2)) < 1e-9, `/pose ${i}`);
  });
  of('/sonar').forEach(({json}, i) => {
    const echoes = of('SONAR')[i].json.has_echo.filter((echo, disc) => echo && of('SONAR')[i].json.range_utime[disc] > 0).length;
    expect(Buffer.from(json.data, 'base64').length === 12 * echoes, `/sonar ${i}: not ${echoes} points`);
  });
  of('/camera').forEach(({json}, i) => expect(Buffer.from(json.data, 'base64').length === of('CAMERA_IMAGE')[i].json.size, `/camera ${i}`));
  of('/camera/fixtures').forEach(({json}, i) => {
    expect(json.points.length === of('FIXTURE_DETECTIONS')[i].json.count, `/camera/fixtures ${i}`);
  });
  of('/path').forEach(({json}, i) => {
    expect(json.entities[0].lines[0].points.length === of('PATH')[i].json.count, `/path ${i}`);
  });
  const poses = of('POSE').length - of('POSE').filter(({logTime}) => logTime < (of('ODOMETRY')[0]?.logTime ?? 0n)).length;
  expect(Math.abs(of('/tf').length - of('ODOMETRY').length - poses) <= 1, `/tf: ${of('/tf').length}`);
  checkFrames(of('/tf'), of('/pose'));
  for (const {json} of of('/map')) {
    expect(Buffer.from(json.data, 'base64').length % json.column_count === 0, '/map is no rectangle');
    expect(Buffer.from(json.data, 'base64').some((cell) => cell === 100), '/map has no wall');
  }
  expect(of('/map').length >= 1 && of('/log').length >= 1, 'no /map or no /log');
}

// world -> odom -> robot is the pose, at the stamps at which both are told.
function checkFrames(transforms, poses) {
  const newest = {};
  const at = new Map(poses.map(({publishTime, json}) => [publishTime, json.pose]));
  let checked = 0;
  for (const {publishTime, json} of transforms) {
    for (const transform of json.transforms) newest[transform.child_frame_id] = transform;
    const pose = at.get(publishTime);
    if (!pose || !newest.odom || stampOf({timestamp: newest.odom.timestamp}) !== stampOf({timestamp: newest.robot.timestamp})) continue;
    const turn = 2 * Math.atan2(newest.odom.rotation.z, newest.odom.rotation.w);
    const [a, b] = [newest.odom.translation, newest.robot.translation];
    const x = a.x + Math.cos(turn) * b.x - Math.sin(turn) * b.y;
    const y = a.y + Math.sin(turn) * b.x + Math.cos(turn) * b.y;
    expect(Math.hypot(x - pose.position.x, y - pose.position.y) < 1e-9, `/tf at ${publishTime} is not the pose`);
    ++checked;
  }
  expect(checked > 10, `only ${checked} poses have a transform`);
}

rmSync(folder, {recursive: true, force: true});
mkdirSync(folder, {recursive: true});
const file = `${folder}/log.mcap`;
run([log, '--mcap', file]);
run([log, '--csv', `${folder}/csv`]);
const {reader, messages} = await readIndexed(file);
expect(countStreamed(file) === messages.length, 'index and stream differ');
expect(reader.statistics.messageCount === BigInt(messages.length), `statistics: ${reader.statistics.messageCount}`);

const ajv = new Ajv({allErrors: false, strict: false, validateFormats: false});
const validators = new Map();
const topics = new Map();
for (const message of messages) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  const json = JSON.parse(Buffer.from(message.data).toString());
  if (!validators.has(schema.id)) {
    const own = JSON.parse(Buffer.from(schema.data).toString());
    expect(own.title === schema.name, `${schema.name} is called ${own.title}`);
    const theirs = published[schema.name.replace('foxglove.', '')];
    expect(!schema.name.startsWith('foxglove.') || theirs, `${schema.name} is not published`);
    validators.set(schema.id, [ajv.compile(own), ...(schema.name.startsWith('foxglove.') ? [ajv.compile(theirs)] : [])]);
  }
  for (const valid of validators.get(schema.id)) expect(valid(json), `${channel.topic}: ${ajv.errorsText(valid.errors)}`);
  if (!topics.has(channel.topic)) topics.set(channel.topic, []);
  topics.get(channel.topic).push({logTime: message.logTime, publishTime: message.publishTime, json});
}
const raw = [...topics.keys()].filter((topic) => !topic.startsWith('/'));
for (const channel of raw) compare(channel, topics.get(channel));
compareStandard(topics);

// A log that was cut is exported up to the cut, and says so; a foreign file is refused and nothing is left.
copyFileSync(log, `${folder}/cut.lcm`);
truncateSync(`${folder}/cut.lcm`, Math.floor(statSync(log).size / 2));
expect(/cut/.test(run([`${folder}/cut.lcm`, '--mcap', `${folder}/cut.mcap`])), 'nothing is said of a cut');
expect((await readIndexed(`${folder}/cut.mcap`)).messages.length > 100, 'of a cut log nothing is exported');
writeFileSync(`${folder}/foreign.lcm`, 'no log');
run([`${folder}/foreign.lcm`, '--mcap', `${folder}/foreign.mcap`], 1);
expect(!statSync(`${folder}/foreign.mcap`, {throwIfNoEntry: false}), 'a foreign file leaves a result');
run([log, '--mcap', file, '--csv', `${folder}/both`], 2);

console.log(failures.length ? failures.join('\n') :
  `${messages.length} messages on ${topics.size} topics (${raw.length} as they are) agree, ${compared} values, ${statSync(file).size} bytes`);
process.exit(failures.length ? 1 : 0);
