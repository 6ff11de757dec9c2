// A rectangle from corner to corner fills the surface's inside that is seen in it; the steps of the interval key are
// cells of the octree.
import assert from 'node:assert/strict';
import test from 'node:test';
import { noBrowser, Studio } from './browser.mjs';
import { assertNear, ghostsOf, openShape, step, undo, volumeOf } from './steps.mjs';

const inTorus = (x, y, z) => (Math.hypot(x, y) - 0.7) ** 2 + z ** 2 < 0.25 ** 2;

test('a rectangle fills what is seen in it', { skip: noBrowser(), timeout: 180_000 }, async () => {
  const studio = await Studio.open();
  try {
    const { scene, at, digest } = await openShape(studio, 'torus');
    await studio.press('r');
    const shown = await ghostsOf(studio, () => studio.drag([at([0.2, 0.4, 0]), at([0.9, -0.3, 0])], { steps: 4 }));
    const fewer = await ghostsOf(studio, () => studio.press(']'));
    assert.ok(fewer.added < shown.added, `${fewer.added} points of a longer interval, ${shown.added} before`);
    const again = await ghostsOf(studio, () => studio.press('['));
    assert.equal(again.added, shown.added);

    const done = await step(studio, 1, () => studio.press('Enter'));
    assert.equal(done.record.operation, 'guide');
    assert.equal(done.record.added, shown.added, 'added is what was shown');
    const within = (x, y, z) => inTorus(x, y, z) && x > 0.2 && x < 0.9 && y > -0.3 && y < 0.4;
    assertNear(shown.added * done.operation.interval ** 3, volumeOf(within), 0.06, 'within the rectangle');
    assert.equal(done.scene.points, scene.points + shown.added);
    assert.notEqual(done.digest, digest);
    await undo(studio, 1, digest);

    await studio.press('r');
    const since = studio.client.events.length;
    await ghostsOf(studio, () => studio.drag([at([0.2, 0.4, 0]), at([0.9, -0.3, 0])], { steps: 4 }));
    await studio.press('Escape');
    await studio.client.event('ghosts', event => event.added + event.removed === 0, { since });
    assert.equal(await studio.client.digest(), digest, 'Esc drops it');
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});
