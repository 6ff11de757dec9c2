// What is opened is shown whole, once: after that the view is where the hand has put it, in whatever order and however
// late messages come.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import test from 'node:test';
import { noBrowser, Studio } from './browser.mjs';
import { changedBox } from './pixels.mjs';
import { temporaryFolder } from './program.mjs';
import { openShape, step } from './steps.mjs';

/** A sphere as an ASCII PLY with normals. */
function writeSphere(file, { radius, centre, points = 4000 }) {
  const lines = Array.from({ length: points }, (_, i) => {
    const y = 1 - (2 * i + 1) / points;
    const angle = i * Math.PI * (3 - Math.sqrt(5));
    const n = [Math.cos(angle) * Math.sqrt(1 - y * y), y, Math.sin(angle) * Math.sqrt(1 - y * y)];
    return [...n.map((value, a) => centre[a] + radius * value), ...n].join(' ');
  });
  const properties = ['x', 'y', 'z', 'nx', 'ny', 'nz'].map(name => `property float ${name}`);
  writeFileSync(file, ['ply', 'format ascii 1.0', `element vertex ${points}`, ...properties, 'end_header', ...lines, '']
    .join('\n'));
}

/** A new page from which messages of the kind `state` are held back. @returns what lets them through, in their order */
async function holdStates(studio) {
  let holds = true;
  const held = [];
  let send = () => undefined;
  await studio.context.routeWebSocket(/socket/, route => {
    const server = route.connectToServer();
    send = message => route.send(message);
    server.onMessage(message => {
      if (holds && typeof message === 'string' && message.includes('"event":"state"')) held.push(message);
      else route.send(message);
    });
  });
  await studio.page.close();
  studio.page = await studio.newPage();
  return () => {
    holds = false;
    for (const message of held.splice(0)) send(message);
  };
}

/** The picture without what floats over the view for a while. */
async function restingPicture(studio) {
  await studio.page.mouse.move(640, 790);
  await studio.at('chip').waitFor({ state: 'hidden', timeout: 30_000 });
  return studio.picture();
}

test('a view stays as it was turned, however late the state comes', { skip: noBrowser(), timeout: 120_000 }, async () => {
  const studio = await Studio.open();
  try {
    const release = await holdStates(studio);
    await studio.client.request('open', { files: [{ shape: 'sphere', points: 5000 }], options: { depth: 6 } });
    await studio.drawn();
    release();
    await studio.at('status-points').filter({ hasText: '5,000' }).waitFor();
    const canvas = await studio.canvas();
    const middle = [canvas.x + canvas.width / 2, canvas.y + canvas.height / 2];
    await studio.drag([middle, [middle[0] + 80, middle[1] + 30]]);
    const before = await restingPicture(studio);
    const second = { with: { shape: 'sphere', points: 5000 }, translation: [1, 0, 0] };
    const operation = { op: 'boolean', operation: 'union', ...second };
    await step(studio, 1, () => studio.client.request('apply', { operation }));
    const since = studio.client.events.length;
    await studio.client.request('undo');
    await studio.drawn(since);
    assert.equal(changedBox(await restingPicture(studio), before), null, 'the same surface from the same place');
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});

test('what is opened after another scene is shown whole', { skip: noBrowser(), timeout: 120_000 }, async () => {
  const folder = temporaryFolder();
  writeSphere(join(folder, 'large.ply'), { radius: 50, centre: [1000, 0, 0] });
  const studio = await Studio.open({ folder });
  try {
    await openShape(studio, 'sphere');
    const first = await restingPicture(studio);
    const since = studio.client.events.length;
    await studio.client.request('open', { files: [{ path: 'large.ply' }], options: { depth: 6 } });
    await studio.drawn(since);
    const shown = await restingPicture(studio);
    await studio.press('h');
    const box = changedBox(shown, await restingPicture(studio));
    const height = box.bottom - box.top;
    assert.ok(height > 0.6 * first.height && height < first.height - 20, `a sphere of ${height} of ${first.height} pixels`);
    assert.ok(Math.abs(box.left + box.right - first.width) < 10, 'in the middle');
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});

test('a dialog that is open before the engine answers lists its files then', { skip: noBrowser(), timeout: 120_000 }, async () => {
  const folder = temporaryFolder();
  writeSphere(join(folder, 'ball.ply'), { radius: 1, centre: [0, 0, 0] });
  const studio = await Studio.open({ folder });
  try {
    let admit;
    const admitted = new Promise(resolve => { admit = resolve; });
    await studio.context.route('**/session', async route => { await admitted; await route.continue(); });
    await studio.page.close();
    studio.page = await studio.newPage();
    await studio.press('Control+o');
    await studio.at('open-confirm').waitFor();
    admit();
    await studio.at('file-ball.ply').click();
    await studio.at('open-confirm').click();
    await studio.at('status-points').filter({ hasText: '4,000' }).waitFor();
    assert.deepEqual(studio.problems, []);
  } finally {
    await studio.close();
  }
});
