// A part of another file, placed by the gizmo and snapped onto the scan.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { join } from 'node:path';
import test from 'node:test';
import { noBrowser, Studio } from './browser.mjs';
import { generator, temporaryFolder } from './program.mjs';
import { assertNear, ghostsOf, markAt, meshBox, openShape, step, undo } from './steps.mjs';

const pointsOfPart = 4000;

/** Chooses the file, whose points are then shown beside the scene, and waits until they can be placed. */
async function chooseFile(studio, name) {
  await studio.press('c');
  await studio.at('part-from-file').click();
  await studio.at(`part-file-${name}`).click();
  await studio.at('gizmo-move-x').waitFor();
  await studio.at('viewport').focus();
}

test('a part of a file is placed by the gizmo and snaps', { skip: noBrowser(), timeout: 180_000 }, async () => {
  const folder = temporaryFolder();
  const made = spawnSync(generator,
    ['torus', '-o', join(folder, 'other.ply'), '--points', String(pointsOfPart), '--seed', '5']);
  assert.equal(made.status, 0, String(made.stderr));
  const studio = await Studio.open({ folder });
  try {
    const { scene, digest } = await openShape(studio, 'torus');
    const before = await meshBox(studio);
    await chooseFile(studio, 'other.ply');
    // The view was made wider to show the part; a field says how far away it is, an arrow moves it.
    const away = async () => Number(await studio.at('part-position-x').inputValue());
    const start = await away();
    assert.ok(start > 1.9, `beside the torus, at ${start}`);
    const height = Number(await studio.at('part-position-y').inputValue());
    const [x, y] = await markAt(studio, 'gizmo-move-x');
    await ghostsOf(studio, () => studio.drag([[x, y], [x - 50, y + 20]]));
    const scale = (start - await away()) / 50;  // world units of a pixel
    assert.equal(Number(await studio.at('part-position-y').inputValue()), height, 'along its axis alone');
    const [x2, y2] = await markAt(studio, 'gizmo-move-x');
    const rest = (await away() - 0.08) / scale;
    await ghostsOf(studio, () => studio.drag([[x2, y2], [x2 - rest, y2]]));
    assertNear(await away(), 0.08, 0.2, 'near the torus');

    const ghosts = await ghostsOf(studio, () => studio.at('part-snap').click());
    assert.equal(ghosts.added, pointsOfPart);
    await studio.at('viewport').focus();
    const done = await step(studio, 1, () => studio.press('Enter'));
    assert.equal(done.record.operation, 'insert');
    assert.equal(done.record.added, pointsOfPart);
    assert.equal(done.record.snapped, true);
    assert.equal(done.scene.points, scene.points + pointsOfPart);
    assert.deepEqual([done.record.after.components, done.record.after.genus], [1, 1]);
    const after = await meshBox(studio);
    assert.ok(Math.abs(after.upper[0] - before.upper[0]) < 0.03, `snapped: reaches to ${after.upper[0]}`);
    assert.notEqual(done.digest, digest);
    await undo(studio, 1, digest);
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});
