// The eraser takes away points that were added and leaves those of the scan; with Shift it takes those, too, and the
// front layer alone where that is chosen.
import assert from 'node:assert/strict';
import test from 'node:test';
import { noBrowser, Studio } from './browser.mjs';
import { assertNear, ghostsOf, openShape, step, undo } from './steps.mjs';

test('added points, then the front layer of the scan', { skip: noBrowser(), timeout: 180_000 }, async () => {
  const studio = await Studio.open();
  try {
    const { scene, at, digest } = await openShape(studio, 'torus');
    const box = (x0, y0, x1, y1) => [at([x0, y0, 0]), at([x1, y1, 0])];
    await studio.press('r');
    await ghostsOf(studio, () => studio.drag(box(0.5, -0.2, 0.9, 0.2)));
    const guided = await step(studio, 1, () => studio.press('Enter'));

    await studio.press('e');
    const ghosts = await ghostsOf(studio, () => studio.drag(box(0, -1, 1, 0)));  // begins below the chip
    const halved = await step(studio, 2, () => studio.press('Enter'));
    assert.equal(halved.record.operation, 'remove');
    assert.equal(halved.record.removed, ghosts.removed);
    assertNear(halved.record.removed, guided.record.added / 2, 0.1, 'the lower half of what was added');
    await ghostsOf(studio, () => studio.drag(box(0, 0, 1, 1)));
    const cleared = await step(studio, 3, () => studio.press('Enter'));
    assert.equal(cleared.scene.points, scene.points, 'none of the scan was taken');

    const through = await ghostsOf(studio, () => studio.drag(box(-1, -0.2, -0.4, 0.2), { modifiers: ['Shift'] }));
    const front = await ghostsOf(studio, () => studio.at('erase-layers-front').click());
    assertNear(front.removed, through.removed / 2, 0.2, 'the front layer is one of two');
    await studio.at('viewport').focus();
    const opened = await step(studio, 4, () => studio.press('Enter'));
    assert.equal(opened.record.removed, front.removed);
    assert.equal(opened.scene.points, scene.points - front.removed);
    assert.equal(new Set([digest, guided.digest, halved.digest, opened.digest]).size, 4, 'each changes the mesh');

    const before = [digest, guided.digest, halved.digest, cleared.digest];
    for (const done of [4, 3, 2, 1]) await undo(studio, done, before[done - 1]);
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});
