// A polygon by clicks: Backspace takes the last corner back, the first Enter closes, the second one adds.
import assert from 'node:assert/strict';
import test from 'node:test';
import { noBrowser, Studio } from './browser.mjs';
import { assertNear, ghostsOf, openShape, step, undo, volumeOf } from './steps.mjs';

const inTorus = (x, y, z) => (Math.hypot(x, y) - 0.7) ** 2 + z ** 2 < 0.25 ** 2;
const square = [[0.4, -0.3, 0], [1, -0.3, 0], [1, 0.3, 0], [0.4, 0.3, 0]];

test('a polygon without the corner that was taken back', { skip: noBrowser(), timeout: 180_000 }, async () => {
  const studio = await Studio.open();
  try {
    const { scene, at, digest } = await openShape(studio, 'torus');
    await studio.press('p');
    for (const corner of square) await studio.page.mouse.click(...at(corner));
    await studio.page.mouse.click(...at([-0.9, 0.9, 0]));  // would take in half of the torus
    await studio.press('Backspace');
    const ghosts = await ghostsOf(studio, () => studio.press('Enter'));
    assert.equal(await studio.at('shape-handle-3').count(), 1, 'four corners');
    assert.equal(await studio.at('shape-handle-4').count(), 0);

    const done = await step(studio, 1, () => studio.press('Enter'));
    assert.equal(done.record.operation, 'guide');
    assert.equal(done.record.added, ghosts.added, 'added is what was shown');
    assertNear(done.record.added * done.operation.interval ** 3,
      volumeOf((x, y, z) => inTorus(x, y, z) && x > 0.4 && Math.abs(y) < 0.3), 0.06, 'what is filled');
    assert.equal(done.scene.points, scene.points + ghosts.added);
    assert.notEqual(done.digest, digest);
    await undo(studio, 1, digest);
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});
