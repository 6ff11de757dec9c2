// A cloud of 20 million points in the studio: how long until it is seen, what an edit takes, the memory of the server,
// beside that of `pointskin reconstruct`, and of the page, and whether a surface that is shown coarser is saved in full.
//
//     POINTSKIN_PROGRAM=build/bin/pointskin POINTSKIN_GENERATE=build/bin/pointskin_generate \
//       node bench/studio/big.mjs [POINTS] [DEPTH] [SHAPE] [STROKES]
//
// 9500000 11 gyroid 0 has 67 million triangles, of which the page shows 1.6 million. Needs about 12 GB of memory, 20 for that, and 3 GB of disk in the
// folder for temporary files.
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { spawnSync } from 'node:child_process';
import { Studio } from '../../tests/studio/browser/browser.mjs';
import { generator, program, temporaryFolder } from '../../tests/studio/browser/program.mjs';
import { frontView } from '../../tests/studio/browser/projection.mjs';

const points = Number(process.argv[2] ?? 20_000_000);
const depth = Number(process.argv[3] ?? 9);
const shape = process.argv[4] ?? 'sphere';
const strokes = Number(process.argv[5] ?? 6);
const folder = temporaryFolder();
const cloud = join(folder, 'big.ply');
const say = (what, value) => console.log(`${what.padEnd(52)} ${value}`);
const gigabytes = bytes => `${(bytes / 1e9).toFixed(2)} GB`;

/** Memory that the page's process holds: the largest child of chromium that is not its GPU. */
function pageMemory() {
  let most = 0;
  for (const pid of readdirSync('/proc').filter(name => /^\d+$/.test(name)))
    try {
      if (!readFileSync(`/proc/${pid}/cmdline`, 'utf8').includes('--type=renderer')) continue;
      most = Math.max(most, 1024 * Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, 'utf8'))[1]));
    } catch { /* it ended meanwhile */ }
  return most;
}

const made = spawnSync(generator, [shape, '-o', cloud, '--points', String(points)], { encoding: 'utf8' });
if (made.status !== 0) throw new Error(made.stderr);
const alone = spawnSync('/usr/bin/env', ['bash', '-c',
  `"$0" reconstruct "$1" --depth ${depth} -o "$2" --report "$3" -q`, program, cloud, join(folder, 'alone.ply'), join(folder, 'alone.json')],
  { encoding: 'utf8' });
if (alone.status !== 0) throw new Error(alone.stderr);
const engine = JSON.parse(readFileSync(join(folder, 'alone.json'))).memory.host_peak_bytes;
say('memory of reconstruct alone', gigabytes(engine));

const studio = await Studio.open({ folder });
try {
  const start = Date.now();
  const since = studio.client.events.length;
  const opening = studio.client.request('open', { files: [{ path: cloud }], options: { depth } });
  await studio.client.event('points', () => true, { since, timeout: 300_000 });
  say('first points announced, s', ((Date.now() - start) / 1000).toFixed(1));
  await opening;
  const mesh = await studio.drawn(since);
  say('surface drawn, s', ((Date.now() - start) / 1000).toFixed(1));
  say('triangles shown, of', `${mesh.triangles} ${mesh.full_triangles}`);
  if (mesh.triangles < mesh.full_triangles) say('  the page says', `${await studio.at('status-triangles').innerText()} triangles, ${await studio.at('status-shown').innerText()} shown`);
  const { scene } = await studio.client.request('hello');
  const at = await frontView(studio, scene.box);
  for (let k = 0; k < strokes; ++k) {
    await studio.press('b');
    await studio.drag([at([-0.1, 0.1 + 0.05 * k, 0]), at([0.1, 0.12 + 0.05 * k, 0])]);
    await studio.page.waitForTimeout(3000);
    const before = Date.now();
    const from = studio.client.events.length;
    await studio.press('Enter');
    const { scene: after } = await studio.client.event('state', event => event.scene?.done === k + 1, { since: from, timeout: 300_000 });
    say('a stroke, s', `${((Date.now() - before) / 1000).toFixed(1)}, ${after.history[k].record.added} points added`);
  }
  await studio.page.waitForTimeout(15_000);
  const peak = await studio.program.peakMemory();
  say('memory of the server, at its highest', `${gigabytes(peak)}, beyond the engine ${gigabytes(peak - engine)} (asked <= 4 GB)`);
  say('memory of the page', `${gigabytes(pageMemory())} (asked <= 1.5 GB)`);
  const saved = await studio.client.request('save', { what: 'mesh', name: 'saved.ply' });
  say('saved, MB', (saved.bytes / 1e6).toFixed(0));
  const info = spawnSync(program, ['info', saved.path], { encoding: 'utf8' });
  say('triangles in the file', /triangles +(\d+)/.exec(info.stdout)?.[1] ?? info.stderr);
} finally {
  await studio.close();
}
