// Where a place of the world is on the page. The test knows the view by its key (front, orthographic, framed) and finds
// the scale where the silhouette of what is drawn begins and ends: nothing is asked of the page.
import { changedBox } from './pixels.mjs';

/**
 * Looks at the scene from the front (key 1), orthographically (key 5), framed (F).
 * @param studio  with a mesh on screen whose box in the world is `box`: {lower: [3], upper: [3]}
 * @returns {Promise<(place: number[]) => number[]>} pixels of the page of a place
 */
export async function frontView(studio, box) {
  await studio.at('viewport').focus();
  await studio.page.keyboard.press('1');
  if (await studio.page.getByTestId('projection').getAttribute('data-value') !== 'orthographic')
    await studio.page.keyboard.press('5');
  await studio.page.keyboard.press('f');
  const drawn = await silhouette(studio);
  const canvas = await studio.canvas();
  const scale = (drawn.right - drawn.left + 1) / (box.upper[0] - box.lower[0]);
  const middle = [(drawn.left + drawn.right + 1) / 2, (drawn.top + drawn.bottom + 1) / 2];
  const centre = box.lower.map((value, i) => (value + box.upper[i]) / 2);
  return place => [canvas.x + middle[0] + scale * (place[0] - centre[0]),
    canvas.y + middle[1] - scale * (place[1] - centre[1])];
}

/**
 * The box of the pixels that the mesh covers: what changes when it is hidden (key H) and comes back with it. A message
 * over the canvas that goes meanwhile does not come back.
 */
async function silhouette(studio) {
  const shown = await studio.picture();
  await studio.page.keyboard.press('h');
  const hidden = await studio.picture();
  await studio.page.keyboard.press('h');
  const again = await studio.picture();
  const box = changedBox(shown, hidden, { like: again });
  if (!box) throw new Error('the canvas shows no mesh');
  return box;
}
