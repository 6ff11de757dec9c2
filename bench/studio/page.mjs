// What a person at the page waits for, by the page's own marks: points on the screen, a stroke until its surface is
// drawn, previews while a slider moves, and whether the page's thread was ever busy for long.
//
//     POINTSKIN_PROGRAM=build/bin/pointskin node bench/studio/page.mjs CLOUD [--strokes N]
//
// Prints one line a measure. Run it on a quiet machine; chromium draws by the CPU where there is no GPU.
import { copyFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { slide } from '../../tests/studio/browser/actions.mjs';
import { Studio } from '../../tests/studio/browser/browser.mjs';
import { temporaryFolder } from '../../tests/studio/browser/program.mjs';
import { frontView } from '../../tests/studio/browser/projection.mjs';

const cloud = process.argv[2];
if (!cloud) throw new Error('usage: page.mjs CLOUD [--strokes N]');
const strokes = Number(process.argv[process.argv.indexOf('--strokes') + 1] || 7) || 7;

const median = values => [...values].sort((a, b) => a - b)[values.length >> 1];
const line = (what, value, bound) => console.log(`${what.padEnd(52)} ${value.toFixed(1).padStart(9)}   asked ${bound}`);
const marks = (page, name) => page.evaluate(wanted => performance.getEntriesByName(wanted)
  .map(mark => ({ at: mark.startTime, version: mark.detail?.version ?? 0 })), name);

/** Tasks of the page's thread over 50 ms, in milliseconds, from now on. */
async function watchTasks(page) {
  await page.evaluate(() => {
    globalThis.longTasks = [];
    new PerformanceObserver(list => globalThis.longTasks.push(...list.getEntries().map(task => task.duration)))
      .observe({ type: 'longtask', buffered: true });
  });
}

const folder = temporaryFolder();
const file = join(folder, basename(cloud));
copyFileSync(cloud, file);
const studio = await Studio.open({ folder, args: [file, '--threads', '2'] });
try {
  const { page, client } = studio;
  await studio.drawn();
  await page.reload();  // the page's start, the program being there
  await page.waitForFunction(() => performance.getEntriesByName('psk:points-drawn').length > 0);
  line('points on the screen after the page begins, ms', (await marks(page, 'psk:points-drawn'))[0].at, '<= 1500');
  await page.waitForTimeout(3000);
  await watchTasks(page);

  const { scene } = await client.request('hello');
  const at = await frontView(studio, scene.box);
  const middle = scene.box.lower.map((low, i) => (low + scene.box.upper[i]) / 2);
  const reach = 0.08 * (scene.box.upper[1] - scene.box.lower[1]);
  await studio.press('b');
  const waits = [];
  const beyond = [];
  for (let i = 0; i < strokes; i += 1) {
    const y = middle[1] - (i / strokes) * reach * 2;  // within the body
    await studio.drag([at([middle[0] - reach, y, 0]), at([middle[0] + reach, y + reach, 0])], { steps: 4 });
    await page.waitForTimeout(1500);  // a look at the ghosts
    const since = client.events.length;
    const before = await page.evaluate(() => performance.now());
    await studio.press('Enter');
    const mesh = await studio.drawn(since);
    const drawn = (await marks(page, 'psk:mesh-drawn')).find(mark => mark.version >= mesh.version);
    const state = await client.event('state', event => event.scene.done === i + 1, { since });
    waits.push(drawn.at - before);
    beyond.push(drawn.at - before - state.scene.history[i].record.total_ms);
  }
  line('stroke committed until its surface is drawn, ms', median(waits), 'engine + 250');
  line('  of it beyond the engine', median(beyond), '<= 250');

  await studio.press('v');
  const from = client.events.length;
  const start = Date.now();
  await slide(studio, 'opt-screening', 0.9, { steps: 60, pause: 50 });
  const seconds = (Date.now() - start) / 1000;
  const previews = client.events.slice(from).filter(event => event.event === 'mesh' && event.preview).length;
  line('previews a second while a slider moves', previews / seconds, '>= 5');
  await page.waitForTimeout(1500);

  const tasks = await page.evaluate(() => globalThis.longTasks);
  line('tasks of the page over 50 ms', tasks.length, '0 outside of WebGL');
  if (tasks.length > 0) line('  the longest of them, ms', Math.max(...tasks), '<= 50');
  const blob = (await client.get(`/blob/${client.events.filter(event => event.event === 'mesh').at(-1).blob}?coding=compressed`));
  line('the surface coded, MB', blob.length / 1e6, '<= 2.7 at 375,000 triangles');
} finally {
  await studio.close();
}
