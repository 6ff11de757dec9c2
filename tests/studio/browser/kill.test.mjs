// A server that is killed at any moment has all that it acknowledged when it is resumed.
import assert from 'node:assert/strict';
import test from 'node:test';
import { Client } from './client.mjs';
import { Program, temporaryFolder } from './program.mjs';
import { operationFrom, randomFrom } from './random_operations.mjs';

const rounds = Number(process.env.POINTSKIN_KILL_ROUNDS ?? 8);

/** Applies operations until the program dies. @returns the acknowledged ones, with the digest after some */
async function workUntilKilled(program, client, random, known) {
  const acknowledged = [...known];
  setTimeout(() => program.kill('SIGKILL'), 50 + 600 * random());
  const ended = program.ended.then(() => 'ended');
  while (true) {
    const operation = operationFrom(random);
    const reply = await Promise.race([client.ask('apply', { operation }), ended]);
    if (reply === 'ended') return acknowledged;
    if (!reply.error) acknowledged.push(operation.op);
  }
}

test(`killed ${rounds} times at random: nothing acknowledged is missing`, { timeout: 900_000 }, async () => {
  const folder = temporaryFolder();
  const random = randomFrom(11);
  let known = [];
  for (let round = 0; round <= rounds; round += 1) {
    const program = await Program.start({ folder, args: round === 0 ? [] : ['--resume'] });
    const client = await Client.connect(program);
    if (round === 0)
      await client.request('open', { files: [{ shape: 'torus', points: 3000 }], options: { depth: 5 } });
    const { scene } = await client.request('hello');
    const done = scene.history.slice(0, scene.done).map(entry => entry.operation.op);
    // What was on its way when the program was killed may be there or not.
    assert.ok(done.length - known.length <= 1, `${done.length} after ${known.length}`);
    assert.deepEqual(done.slice(0, known.length), known, `round ${round}`);
    if (round < rounds) known = await workUntilKilled(program, client, random, done);
    else await program.kill();
  }
  assert.ok(known.length >= rounds, `${known.length} operations were acknowledged in all`);
});
