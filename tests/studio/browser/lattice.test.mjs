// A lattice around the torus: the control points of its upper face are chosen by a band and dragged down.
import assert from 'node:assert/strict';
import test from 'node:test';
import { noBrowser, Studio } from './browser.mjs';
import { assertNear, meshBox, openShape, script, step, undo } from './steps.mjs';

/** Middle of a control point on the page. */
async function controlPoint(studio, id) {
  const { x, y, width, height } = await studio.at(`lattice-point-${id}`).boundingBox();
  return [x + width / 2, y + height / 2];
}

test('a torus is pressed flat by its lattice', { skip: noBrowser(), timeout: 180_000 }, async () => {
  const studio = await Studio.open();
  try {
    const { scene, at, digest } = await openShape(studio, 'torus');
    const before = await meshBox(studio);
    await studio.press('g');
    const [left, middle, right] = [await controlPoint(studio, '0-2-2'), await controlPoint(studio, '1-2-2'),
      await controlPoint(studio, '2-2-2')];
    await studio.drag([[left[0] - 15, left[1] + 20], [right[0] + 15, right[1] - 6]], { modifiers: ['Shift'] });
    assert.match(await studio.at('tool-state').innerText(), /^9 control points/);

    const fall = 0.5;
    const pixels = at([0, 0, 0])[1] - at([0, fall, 0])[1];
    const done = await step(studio, 1, () => studio.drag([middle, [middle[0], middle[1] + pixels]]));
    assert.equal(done.record.operation, 'deform');
    assert.equal(done.scene.points, scene.points - done.record.removed);
    assert.deepEqual([done.record.after.components, done.record.after.genus], [1, 1]);
    const [{ spans, control }] = (await script(studio))[0].lattices;
    assert.deepEqual(spans, [2, 2, 2]);
    const layer = j => control.filter((_, i) => Math.floor(i / 3) % 3 === j).map(([, y]) => y);
    for (const y of layer(0)) assertNear(y, control[0][1], 1e-9, 'the lower face stays');
    for (const y of layer(2)) assertNear(y, -control[0][1] - fall, 0.02, 'the upper face is moved');
    const after = await meshBox(studio);
    assert.ok(after.upper[1] < before.upper[1] - fall / 2, `reaches to ${after.upper[1]}`);
    assert.ok(Math.abs(after.lower[1] - before.lower[1]) < 0.06, 'the lower face stays');
    assert.notEqual(done.digest, digest);
    await undo(studio, 1, digest);
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});
