// Undo of everything, through the protocol: every state is the bytes that it was, on the way back and again forwards. Two
// hundred operations take the same way without the protocol in tests/studio/scene.
import assert from 'node:assert/strict';
import test from 'node:test';
import { Client } from './client.mjs';
import { Program } from './program.mjs';
import { operationFrom, randomFrom } from './random_operations.mjs';

const operations = Number(process.env.POINTSKIN_HISTORY_OPERATIONS ?? 100);

test(`${operations} random operations undone to the first and redone to the last`, { timeout: 900_000 }, async () => {
  const program = await Program.start();
  const client = await Client.connect(program);
  try {
    await client.request('open', { files: [{ shape: 'torus', points: 3000 }], options: { depth: 5 } });
    const random = randomFrom(7);
    const digests = [await client.digest()];
    const kinds = new Set();
    while (digests.length <= operations) {
      const operation = operationFrom(random);
      const reply = await client.ask('apply', { operation });
      if (reply.error) {  // refused: nothing may have changed
        assert.equal(await client.digest(), digests.at(-1), JSON.stringify(operation));
        continue;
      }
      kinds.add(operation.op);
      digests.push(await client.digest());
    }
    assert.deepEqual([...kinds].sort(),
      ['boolean', 'deform', 'flip', 'guide', 'insert', 'options', 'orient', 'remove']);
    assert.ok(new Set(digests).size > operations / 3, 'most operations change the mesh');
    for (let done = operations - 1; done >= 0; done -= 1) {
      await client.request('undo');
      assert.equal(await client.digest(), digests[done], `undone to ${done}`);
    }
    for (let done = 1; done <= operations; done += 1) {
      await client.request('redo');
      assert.equal(await client.digest(), digests[done], `redone to ${done}`);
    }
    for (const done of [operations >> 1, 3, operations]) {
      await client.request('go', { done });
      assert.equal(await client.digest(), digests[done], `gone to ${done}`);
    }
  } finally {
    client.close();
    await program.kill();
  }
});
