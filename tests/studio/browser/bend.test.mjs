// Two handles set by clicks: one holds, the other is dragged by its gizmo, and the torus bends between them.
import assert from 'node:assert/strict';
import test from 'node:test';
import { noBrowser, Studio } from './browser.mjs';
import { markAt, meshBox, openShape, step, undo } from './steps.mjs';

test('a torus is bent by two handles', { skip: noBrowser(), timeout: 180_000 }, async () => {
  const studio = await Studio.open();
  try {
    const { scene, at, digest } = await openShape(studio, 'torus');
    const before = await meshBox(studio);
    await studio.press('d');
    await studio.page.mouse.click(...at([-0.7, 0, 0]));
    await studio.page.mouse.click(...at([0.7, 0, 0]));
    assert.match(await studio.at('tool-state').innerText(), /^2 handles/);

    const [x, y] = await markAt(studio, 'gizmo-move-y');
    const rise = 0.4;
    const pixels = at([0, 0, 0])[1] - at([0, rise, 0])[1];
    const done = await step(studio, 1, () => studio.drag([[x, y], [x + 15, y - pixels / 2], [x, y - pixels]]));
    assert.equal(done.record.operation, 'deform');
    assert.equal(done.scene.points, scene.points);
    assert.deepEqual([done.record.after.components, done.record.after.genus], [1, 1]);
    const { handles } = done.operation;
    assert.equal(handles.length, 2);
    assert.deepEqual([handles[0].rigid.degrees, handles[0].rigid.translation], [0, [0, 0, 0]], 'the first one holds');
    for (const [i, x] of [-0.7, 0.7].entries()) {
      const { centre } = handles[i].region.ball;
      assert.ok(Math.hypot(centre[0] - x, centre[1], centre[2] - 0.25) < 0.02, `set on the surface: ${centre}`);
    }
    const [dx, dy, dz] = handles[1].rigid.translation;
    assert.ok(dx === 0 && dz === 0 && Math.abs(dy - rise) < 0.02, `moved by ${[dx, dy, dz]}`);
    const after = await meshBox(studio);
    assert.ok(after.upper[1] > before.upper[1] + rise / 4, `rises to ${after.upper[1]}`);
    assert.ok(Math.abs(after.lower[0] - before.lower[0]) < 0.1, 'held on the left');
    assert.notEqual(done.digest, digest);
    await undo(studio, 1, digest);
    const back = await meshBox(studio);
    assert.deepEqual(back, before);
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});
