// The four set operations with a second solid that the gizmo has moved: volumes are those of the two solids and of what
// they have in common.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { join } from 'node:path';
import test from 'node:test';
import { noBrowser, Studio } from './browser.mjs';
import { generator, temporaryFolder } from './program.mjs';
import { assertNear, choose, markAt, openShape, step, undo } from './steps.mjs';

const radius = 1;
const ball = (4 / 3) * Math.PI * radius ** 3;

/** What two balls have in common whose middles are `apart`. */
const lens = apart => (Math.PI * (2 * radius - apart) ** 2 * (apart ** 2 + 4 * radius * apart)) / (12 * apart);

/** A second ball, moved to the right by the arrow of its gizmo. @returns how far */
async function placeBall(studio, label, at) {
  await studio.press('u');
  await choose(studio, 'combine-operation', label);
  await studio.at('solid-from-file').click();
  await studio.at('solid-file-ball.ply').click();
  await studio.at('gizmo-move-x').waitFor();
  const [x, y] = await markAt(studio, 'gizmo-move-x');
  const pixels = at([0.8, 0, 0])[0] - at([0, 0, 0])[0];
  await studio.drag([[x, y], [x + pixels, y]]);
  return Number(await studio.at('solid-position-x').inputValue());
}

test('union, intersection, difference and symmetric difference', { skip: noBrowser(), timeout: 300_000 }, async () => {
  const folder = temporaryFolder();
  const made = spawnSync(generator, ['sphere', '-o', join(folder, 'ball.ply'), '--points', '5000', '--seed', '5']);
  assert.equal(made.status, 0, String(made.stderr));
  const studio = await Studio.open({ folder });
  try {
    const { at, digest } = await openShape(studio, 'sphere');
    const expected = {
      union: ['Union', apart => 2 * ball - lens(apart)],
      intersection: ['Intersection', apart => lens(apart)],
      difference: ['Difference', apart => ball - lens(apart)],
      symmetric: ['Symmetric', apart => 2 * ball - 2 * lens(apart)],
    };
    const digests = new Set([digest]);
    for (const [operation, [label, volume]] of Object.entries(expected)) {
      const apart = await placeBall(studio, label, at);
      assertNear(apart, 0.8, 0.03, 'moved to the right');
      const done = await step(studio, 1, () => studio.press('Enter'));
      assert.equal(done.record.operation, 'boolean');
      assert.equal(done.operation.operation, operation);
      assertNear(done.operation.translation[0], apart, 0.01, 'as it was placed');
      assertNear(done.scene.surface.volume, volume(apart), 0.05, operation);
      assert.ok(done.scene.surface.watertight, `${operation} is watertight`);
      digests.add(done.digest);
      await undo(studio, 1, digest);
    }
    assert.equal(digests.size, 5, 'four different meshes');
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});
