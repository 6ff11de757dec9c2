// The figure of the paper: two fingers that have grown together are parted by one stroke, seen before it is done, undone
// and redone, saved, and replayed by the command line to the same bytes.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import test from 'node:test';
import { save } from './actions.mjs';
import { noBrowser, Studio } from './browser.mjs';
import { changedBox, colours } from './pixels.mjs';
import { runProgram, temporaryFolder } from './program.mjs';
import { frontView } from './projection.mjs';

const sha256 = file => createHash('sha256').update(readFileSync(file)).digest('hex');


test('two fingers are parted by a stroke', { skip: noBrowser(), timeout: 240_000 }, async () => {
  const folder = temporaryFolder();
  const studio = await Studio.open({ folder, args: ['--demo'] });
  try {
    const first = await studio.drawn();
    const { scene } = await studio.client.request('hello');
    assert.ok(colours(await studio.picture()) > 20, 'the canvas shows the hand');
    const at = await frontView(studio, scene.box);
    const before = await studio.client.digest();
    const grown = (await studio.client.event('state', event => event.scene?.topology)).scene.topology;
    assert.deepEqual([grown.components, grown.genus], [1, 1]);
    assert.equal(await studio.at('status-genus').innerText(), '1');

    await studio.press('b');
    const bare = await studio.picture();
    await studio.drag([at([0.235, 0.4, 0]), at([0.235, 0.7, 0]), at([0.235, 1, 0])], { steps: 12 });
    const ghosts = await studio.client.event('ghosts', event => event.added > 0);
    await studio.seen('ghosts are seen', picture => changedBox(picture, bare)?.pixels > 50);
    const since = studio.client.events.length;
    await studio.press('Enter');
    const parted = await studio.drawn(since);
    assert.ok(parted.version > first.version);
    const done = await studio.client.event('state', event => event.scene.done === 1, { since });
    const { record } = done.scene.history[0];
    assert.equal(record.operation, 'guide');
    assert.ok(record.added > 0 && record.added === ghosts.added, `${record.added} added, ${ghosts.added} shown`);
    assert.deepEqual([record.before.genus, record.after.genus], [1, 0]);
    const chip = await studio.at('chip').innerText();
    assert.match(chip, /\+[\d,]+ points/);
    assert.match(chip, /genus 1 → 0/);
    const after = await studio.client.digest();
    assert.notEqual(after, before);

    await studio.press('Control+z');
    await studio.client.event('state', event => event.scene.done === 0, { since });
    assert.equal(await studio.client.digest(), before, 'undone: the old bytes');
    await studio.press('Control+Shift+Z');
    await studio.client.event('state', event => event.scene.done === 1, { since: studio.client.events.length - 1 });
    assert.equal(await studio.client.digest(), after, 'redone: the new bytes');

    await save(studio, 'parted.ply', 'mesh');
    await save(studio, 'parted.json', 'session');
    const replayed = join(folder, 'replayed.ply');
    const edit = runProgram('edit', '--script', join(folder, 'parted.json'), '-o', replayed);
    assert.equal(edit.status, 0, edit.stderr);
    assert.equal(sha256(replayed), sha256(join(folder, 'parted.ply')));
    assert.equal(sha256(replayed), after);
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});
