// A lasso with a hole: a loop inside another, drawn with Alt held, takes its inside out of what is filled.
import assert from 'node:assert/strict';
import test from 'node:test';
import { noBrowser, Studio } from './browser.mjs';
import { assertNear, circle, ghostsOf, openShape, step, undo, volumeOf } from './steps.mjs';

const inTorus = (x, y, z) => (Math.hypot(x, y) - 0.7) ** 2 + z ** 2 < 0.25 ** 2;

test('a lasso with a hole fills what is between its loops', { skip: noBrowser(), timeout: 180_000 }, async () => {
  const studio = await Studio.open();
  try {
    const { scene, at, digest } = await openShape(studio, 'torus');
    await studio.press('l');
    const [outer, inner] = [0.8, 0.6].map(radius => circle(radius).map(at));
    const whole = await ghostsOf(studio, () => studio.drag(outer, { steps: 3 }));
    const ring = await ghostsOf(studio, () => studio.drag(inner, { steps: 3, modifiers: ['Alt'] }));
    assert.match(await studio.at('tool-state').innerText(), /points would be added/);

    const done = await step(studio, 1, () => studio.press('Enter'));
    assert.equal(done.record.operation, 'guide');
    assert.equal(done.record.added, ring.added, 'added is what was shown');
    const cell = done.operation.interval ** 3;
    assertNear(whole.added * cell, volumeOf((x, y, z) => inTorus(x, y, z) && Math.hypot(x, y) < 0.8), 0.06, 'one loop');
    const between = (x, y, z) => inTorus(x, y, z) && Math.abs(Math.hypot(x, y) - 0.7) < 0.1;
    assertNear(ring.added * cell, volumeOf(between), 0.06, 'with the hole');
    assert.equal(done.scene.points, scene.points + ring.added);
    assert.notEqual(done.digest, digest);
    assert.equal((await studio.at('status-points').innerText()).replaceAll(',', ''), String(done.scene.points));
    await undo(studio, 1, digest);
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});
