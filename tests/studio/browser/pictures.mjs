// Takes the pictures of docs/studio.md and README.md, by the tools themselves:
//
//     POINTSKIN_PROGRAM=build/bin/pointskin node tests/studio/browser/pictures.mjs docs/pictures [NAME...]
import { join } from 'node:path';
import { pictureOf, Studio } from './browser.mjs';
import { frontView } from './projection.mjs';

const [folder, ...wanted] = process.argv.slice(2);
if (!folder) throw new Error('usage: pictures.mjs FOLDER [NAME...]');

/** A studio on the generated hand, seen from the front, and where its places are on the page. */
async function hand() {
  const studio = await Studio.open({ args: ['--demo'] });
  await studio.drawn();
  const { scene } = await studio.client.request('hello');
  const at = await frontView(studio, scene.box);
  return { studio, at };
}

async function settle(studio, ms = 1500) {
  await studio.page.mouse.move(700, 760);
  await studio.page.waitForTimeout(ms);
}

const around = (x, y, r) => [0, 1, 2, 3, 4, 5, 6, 7, 8].map(i =>
  [x + r * Math.cos((i * Math.PI) / 4), y + r * Math.sin((i * Math.PI) / 4), 0]);

/** What each picture shows; functions of a studio, the places, and a function that takes the picture. */
const scenes = {
  async guide({ studio, at }, take) {
    await settle(studio);
    await take('guide_before');
    await studio.press('b');
    await studio.drag([at([0.235, 0.45, 0]), at([0.235, 0.75, 0]), at([0.235, 1, 0])], { steps: 10 });
    await studio.client.event('ghosts', event => event.added > 0);
    await settle(studio);
    await take('tool_stroke');
    const since = studio.client.events.length;
    await studio.press('Enter');
    await studio.drawn(since);
    await settle(studio, 800);
    await take('guide_after');
  },
  async rectangle({ studio, at }, take) {
    await studio.press('r');
    await studio.drag([at([0.1, 0.95, 0]), at([0.3, 0.55, 0])]);
    await settle(studio);
    await take('tool_rectangle');
  },
  async lasso({ studio, at }, take) {
    await studio.press('l');
    await studio.drag(around(0, -0.3, 0.3).map(at), { steps: 4 });
    await settle(studio);
    await take('tool_lasso');
  },
  async polygon({ studio, at }, take) {
    await studio.press('p');
    for (const place of [[-0.3, -0.1, 0], [0.2, 0, 0], [0.1, -0.6, 0], [-0.2, -0.5, 0]])
      await studio.page.mouse.click(...at(place));
    await settle(studio);
    await take('tool_polygon');
  },
  async erase({ studio, at }, take) {
    await studio.press('e');
    await studio.at('erase-originals').click();
    await studio.drag([at([-0.75, 0.6, 0]), at([-0.3, 0.1, 0])]);
    await settle(studio);
    await take('tool_erase');
  },
  async copyPart({ studio }, take) {
    await studio.press('c');
    await studio.at('part-shape').selectOption('torus');
    await settle(studio, 4000);
    await take('tool_copyPart');
  },
  async bend({ studio, at }, take) {
    await studio.press('d');
    await studio.page.mouse.click(...at([-0.05, -0.75, 0]));
    await studio.page.mouse.click(...at([-0.28, 0.75, 0]));
    await settle(studio);
    const mark = await studio.at('gizmo-move-x').boundingBox();
    const from = [mark.x + mark.width / 2, mark.y + mark.height / 2];
    await studio.drag([from, [from[0] - 60, from[1]], [from[0] - 110, from[1]]], { steps: 12 });
    await settle(studio, 4000);
    await take('tool_bend');
    await take('bend');
  },
  async lattice({ studio }, take) {
    await studio.press('g');
    await settle(studio);
    await take('tool_lattice');
  },
  async combine({ studio }, take) {
    await studio.press('u');
    await studio.at('combine-shape').selectOption('sphere').catch(() => {});
    await settle(studio, 6000);
    await take('tool_combine');
  },
  async orient({ studio }, take) {
    await studio.press('o');
    await settle(studio);
    await take('tool_orient');
  },
  async section({ studio }, take) {
    await studio.press('x');
    await settle(studio);
    await take('tool_section');
  },
  async fluid({ studio }, take) {
    await studio.press('5');  // in perspective, from above
    await studio.press('1');
    const { x, y, width, height } = await studio.canvas();
    await studio.drag([[x + width / 2, y + height / 2], [x + 0.36 * width, y + 0.62 * height]]);
    await studio.press('w');
    await studio.at('fluid-start').click();
    await studio.client.event('frame', frame => frame.index >= 75, { timeout: 180_000 });
    await studio.at('fluid-pause').click();
    await studio.press('f');
    await settle(studio, 4000);
    await take('tool_fluid');
    await take('fluid');
  },
};

for (const [name, show] of Object.entries(scenes)) {
  if (wanted.length > 0 && !wanted.includes(name)) continue;
  const opened = await hand();
  try {
    await show(opened, async what => {
      await pictureOf(opened.studio.page);  // waits for a whole frame
      await opened.studio.page.screenshot({ path: join(folder, `studio_${what}.png`) });
    });
    console.log(name);
  } catch (error) {
    console.log(`${name}: ${error.message.split('\n')[0]}`);
    await opened.studio.page.screenshot({ path: join(folder, `studio_${name}_failed.png`) });
  } finally {
    await opened.studio.close();
  }
}
