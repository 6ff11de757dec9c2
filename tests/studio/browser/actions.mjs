// What people do again and again.

/** The place in the middle of an element, or at a share of its width. */
export async function placeIn(locator, share = 0.5) {
  const box = await locator.boundingBox();
  return [box.x + share * box.width, box.y + box.height / 2];
}

/** Opens a tab of the panels on the right. */
export async function panel(studio, name) {
  await studio.at(`tab-${name}`).click();
}

/** Drags the thumb of a slider to a share of its way, in `steps` moves, `pause` ms apart. */
export async function slide(studio, id, share, { steps = 8, pause = 40 } = {}) {
  const slider = studio.at(id);
  await slider.scrollIntoViewIfNeeded();
  const now = Number(await slider.inputValue());
  const [low, high] = [Number(await slider.getAttribute('min')), Number(await slider.getAttribute('max'))];
  const from = await placeIn(slider, Math.min(0.98, Math.max(0.02, (now - low) / (high - low))));
  const to = await placeIn(slider, share);
  const { mouse } = studio.page;
  await mouse.move(...from);
  await mouse.down();
  for (let i = 1; i <= steps; i += 1) {
    await mouse.move(from[0] + ((to[0] - from[0]) * i) / steps, from[1]);
    await studio.page.waitForTimeout(pause);
  }
  await mouse.up();
}

/** Saves by the dialog. @returns what it says */
export async function save(studio, name, what, { format = null, download = false } = {}) {
  await studio.press('Control+s');
  await studio.at('save-what').selectOption(what).catch(() => studio.at(`save-what-${what}`).click());
  if (format) await studio.at('save-format').selectOption(format);
  await studio.at('save-name').fill(name);
  if (download) await studio.at('save-to-download').click();
  await studio.at('save-confirm').click();
  await studio.page.waitForFunction(() => {
    const all = [document.documentElement];
    for (let i = 0; i < all.length; i += 1) {
      if (all[i].shadowRoot) all.push(...all[i].shadowRoot.querySelectorAll('*'));
      all.push(...all[i].children);
    }
    return all.find(element => element.dataset?.testid === 'saved')?.textContent.toLowerCase().includes('saved');
  }, null, { timeout: 30_000 });
  const said = await studio.at('saved').innerText();
  await studio.press('Escape');
  await studio.at('save-dialog').waitFor({ state: 'detached' });  // keys are the dialog's until then
  return said;
}

/** Waits for a state event after the event number `since` that `accepts`. @returns its scene */
export async function state(studio, since, accepts) {
  return (await studio.client.event('state', event => event.scene && accepts(event.scene), { since })).scene;
}
