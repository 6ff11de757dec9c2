// Saving from the page: in every format, the cloud, the session; what was written is what the server says, and other
// commands read it.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { existsSync, readFileSync, statSync } from 'node:fs';
import { join } from 'node:path';
import test from 'node:test';
import { save } from './actions.mjs';
import { noBrowser, Studio } from './browser.mjs';
import { runProgram } from './program.mjs';

test('every format, cloud and session are saved', { skip: noBrowser(), timeout: 240_000 }, async () => {
  const studio = await Studio.open();
  try {
    const since = studio.client.events.length;
    await studio.client.request('open', { files: [{ shape: 'torus', points: 4000 }], options: { depth: 6 } });
    await studio.drawn(since);
    const { formats } = await studio.client.request('hello');
    const extensions = formats.filter(format => format.mesh).map(format => format.extensions[0]);
    assert.ok(extensions.length >= 3);
    for (const extension of extensions) {
      const name = `torus${extension}`;
      const said = await save(studio, name, 'mesh', { format: extension.slice(1) });
      const file = join(studio.program.folder, name);
      const size = statSync(file).size;
      assert.ok(said.replace(/\D/g, '').includes(String(size)), `${said}: ${size}`);
      const check = runProgram('check', file);
      const isRead = !/which is written, but not read/.test(check.stderr);
      assert.ok(!isRead || [0, 1].includes(check.status), `${name}: ${check.stderr}`);
    }
    const ply = readFileSync(join(studio.program.folder, 'torus.ply'));
    assert.equal(createHash('sha256').update(ply).digest('hex'), await studio.client.digest());
    await save(studio, 'points.ply', 'cloud');
    assert.equal(runProgram('info', join(studio.program.folder, 'points.ply')).status, 0);
    await save(studio, 'scene.json', 'session');
    assert.equal(JSON.parse(readFileSync(join(studio.program.folder, 'scene.json'))).version, 1);
    await save(studio, 'view.png', 'picture');
    assert.ok(existsSync(join(studio.program.folder, 'view.png')));
    assert.equal(readFileSync(join(studio.program.folder, 'view.png')).subarray(1, 4).toString(), 'PNG');
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});
