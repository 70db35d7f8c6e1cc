// texts_test SOURCE FOLDER: all that the page says stands in the German table, and nothing else does. "missing" as a third
// argument prints what is missing.
import assert from 'node:assert/strict';
import {readFileSync, readdirSync} from 'node:fs';
import {pathToFileURL} from 'node:url';

import {copyModules} from './page_modules.mjs';

const [source, folder, only] = process.argv.slice(2);
const web = `${source}/services/viewer/web`;
Object.defineProperty(globalThis, 'localStorage', {value: {getItem: () => 'de'}, configurable: true});
const modules = copyModules(source, folder);
const load = (file) => import(pathToFileURL(`${modules}/${file}`));
const {LANGUAGES, t, translated} = await load('texts.js');
const table = LANGUAGES.de;

// The keys of all t`...` in a text of JavaScript, also of those inside others.
function keysOf(code) {
  const keys = [];
  // Reads a template from behind its first backquote; returns its key and where it ends.
  function template(at) {
    let key = '';
    while (code[at] !== '`') {
      if (code[at] === '\\') { key += code[at + 1]; at += 2; }
      else if (code.startsWith('${', at)) { key += '{}'; at = expression(at + 2); }
      else key += code[at++];
    }
    return [key, at + 1];
  }
  // Reads from behind "${" to behind its "}".
  function expression(at) {
    for (let depth = 1; ; ++at) {
      if (code[at] === '`') {
        const isSpoken = /(^|\W)t$/.test(code.slice(at - 2, at));
        const [key, end] = template(at + 1);
        if (isSpoken) keys.push(key);
        at = end - 1;
      } else if (code[at] === '{') ++depth;
      else if (code[at] === '}' && --depth === 0) return at + 1;
    }
  }
  for (const found of code.matchAll(/(?<=\W)t`/g)) keys.push(template(found.index + 2)[0]);
  return keys;
}

// What the markup says: its texts and the attributes that are read out.
function markupOf(html) {
  const body = html.slice(html.indexOf('<body')).replace(/<!--.*?-->/gs, '');
  // a text goes on over line ends, but not over tags
  const whole = body.split(/<[^>]*>/).map((text) => text.trim().replace(/\s+/g, ' ')).filter(Boolean);
  return [...whole, ...[...body.matchAll(/\s(?:title|aria-label|placeholder)="([^"]*)"/g)].map((found) => found[1])]
    .map((text) => text.replaceAll('&amp;', '&'));
}

const SAME = /^[^\p{L}]*$|^(Luminav|STOP|[\d.]+×)$/u;  // the same in every language
const pages = readdirSync(web).filter((name) => name.endsWith('.html'));
const used = new Set(pages.flatMap((name) => markupOf(readFileSync(`${web}/${name}`, 'utf8'))).filter((text) => !SAME.test(text)));
for (const file of readdirSync(web).filter((name) => name.endsWith('.js') && !['texts.js', 'german.js'].includes(name))) {
  const code = readFileSync(`${web}/${file}`, 'utf8').replace(/^\s*\/\/.*$/gm, '');
  for (const key of keysOf(code)) used.add(key);
}
const names = await load('names.js');
const {LAYERS} = await load('layers.js');
const {MEANINGS} = await load('legend.js');
const lists = [names.POSE, names.NAVIGATION, names.CONTROL, names.NODE, names.SUBJECTS, Object.values(names.JOB_KINDS), Object.values(names.SURVEY_STATES), Object.values(names.ZONE_KINDS), names.JOB_WORDS, names.DAYS, names.ACTIONS, names.CONDITIONS, names.EVERYBODY, names.EXPERTS,
  LAYERS.map(([, label]) => label), Object.values(MEANINGS).map(([, , meaning]) => meaning)];
for (const word of lists.flat()) used.add(word);

const missing = [...used].filter((key) => !(key in table));
if (only === 'missing') console.log(missing.map((key) => `  ${JSON.stringify(key)}: '',`).join('\n'));
assert.deepEqual(missing, [], 'without German');
assert.deepEqual(Object.keys(table).filter((key) => !used.has(key)), [], 'German that nobody says');
for (const [english, german] of Object.entries(table)) {
  const places = (text) => [...text.matchAll(/\{\d?\}/g)].length;
  assert.equal(places(german), places(english), `values of "${english}"`);
  assert(german.trim(), english);
}
assert.equal(t`Drives`, table.Drives);
assert.equal(t`You cannot stop the robot from here: ${'why'}. Use the button on the robot.`.includes('why'), true);
assert.equal(translated('no such text'), 'no such text');
console.log(`${used.size} texts`);
