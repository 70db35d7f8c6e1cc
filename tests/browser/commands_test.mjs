// commands_test SOURCE FOLDER: where only the page's port can be reached, all commands go there, steering too.
import assert from 'node:assert';
import {once} from 'node:events';
import {createServer} from 'node:http';

import {copyModules} from './page_modules.mjs';

const [source, folder] = process.argv.slice(2);
const modules = copyModules(source, folder);

const serve = async (answer, port = 0) => {
  const server = createServer(async (request, response) => {
    request.resume();
    await once(request, 'end');
    answer(request, response);
  }).listen(port, '127.0.0.1');
  await once(server, 'listening');
  return server;
};
const heard = {page: [], own: []};
const take = (where) => (request, response) => {
  if (request.method === 'POST') heard[where].push(request.url);
  response.end(request.url === '/settings.json' ? JSON.stringify({command_port: commandPort}) : '{"id": 7}');
};
let own = await serve(take('own'));
const commandPort = own.address().port;
const page = await serve(take('page'));
const address = `http://127.0.0.1:${page.address().port}`;
globalThis.location = new URL(`${address}/#token=x`);
globalThis.sessionStorage = {getItem: () => null, setItem: () => {}};
const plainFetch = globalThis.fetch;
globalThis.fetch = (url, options) => plainFetch(new URL(url, address), options);

// A page of its own each time: modules of other addresses are other modules.
const open = async (name) => {
  heard.page = [];
  heard.own = [];
  const commands = await import(`${modules}/commands.js?${name}`);
  await commands.settings;
  return commands;
};
const steer = (commands, sequence) => commands.steer({sequence}).catch(() => 'lost');

let commands = await open('reached');
await steer(commands, 1);
await commands.motorsOn();
assert.deepEqual(heard, {page: [], own: ['/api/steering', '/api/motors']});

own.closeAllConnections();
own.close();
assert.equal(await steer(commands, 2), 'lost');
own = await serve(take('own'), commandPort);
await steer(commands, 3);
assert.deepEqual(heard.page, [], 'a port that was reached once is not left');

own.closeAllConnections();
own.close();
commands = await open('tunnel');
assert.equal(await steer(commands, 1), 'lost');
assert.equal(await steer(commands, 2), 7);
await commands.motorsOn();
assert.deepEqual(heard, {page: ['/api/steering', '/api/motors'], own: []});
page.closeAllConnections();
page.close();
console.log('passed');
