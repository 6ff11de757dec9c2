// Normals: estimated, turned round all together, turned round in an area, and towards a sensor that a click sets.
import assert from 'node:assert/strict';
import test from 'node:test';
import { noBrowser, Studio } from './browser.mjs';
import { ghostsOf, openShape, step, undo } from './steps.mjs';

test('normals are estimated, turned, flipped and seen by a sensor', { skip: noBrowser(), timeout: 300_000 }, async () => {
  const studio = await Studio.open();
  try {
    const { scene, at, digest } = await openShape(studio, 'torus');
    await studio.press('o');

    const turned = await step(studio, 1, () => studio.at('orient-turn').click());
    assert.deepEqual([turned.record.operation, turned.operation.method], ['orient', 'turn']);
    assert.equal(turned.record.flipped, scene.points);
    assert.notEqual(turned.digest, digest, 'inside is outside');
    const estimated = await step(studio, 2, () => studio.at('orient-estimate').click());
    assert.equal(estimated.operation.method, 'estimate');
    assert.equal(estimated.record.flipped, scene.points);
    assert.equal(estimated.digest, digest, 'they point outwards again');
    await undo(studio, 2, turned.digest);
    await undo(studio, 1, digest);

    await studio.at('orient-layers-front').click();
    const ghosts = await ghostsOf(studio, () => studio.drag([at([0.5, -0.2, 0]), at([0.9, 0.2, 0])]));
    await studio.at('viewport').focus();
    const flipped = await step(studio, 1, () => studio.press('Enter'));
    assert.equal(flipped.record.operation, 'flip');
    assert.ok(flipped.record.flipped > 50 && flipped.record.flipped === ghosts.added,
      `${flipped.record.flipped} turned, ${ghosts.added} shown`);
    assert.equal(flipped.scene.points, scene.points);
    assert.match(await studio.at('chip').innerText(), /normals turned/);
    await undo(studio, 1, digest);

    await studio.at('orient-mode-sensor').click();
    await studio.page.mouse.click(...at([1.2, 0.3, 0]));
    await studio.at('viewport').focus();
    const seen = await step(studio, 1, () => studio.press('Enter'));
    assert.equal(seen.operation.method, 'estimate');
    assert.equal(seen.operation.sensors.length, 1);
    const [x, y, z] = seen.operation.sensors[0];
    assert.ok(Math.hypot(x - 1.2, y - 0.3, z) < 0.02, `the sensor is where the click was: ${[x, y, z]}`);
    assert.ok(![digest, turned.digest].includes(seen.digest), 'the sensor counts');
    await undo(studio, 1, digest);
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});
