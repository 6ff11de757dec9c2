// What a person sees, in both themes: no text without contrast, no control without a name, nothing cut off, by axe-core and
// by measuring; and every command is reached by the keyboard alone.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import test from 'node:test';
import { panel } from './actions.mjs';
import { noBrowser, pictureOf, Studio } from './browser.mjs';
import { require } from './packages.mjs';

const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
const pictures = process.env.POINTSKIN_LOOKS;  // a folder for pictures of all, to be looked at

/** Looks for broken rules, one line each. The page's policy forbids scripts of others: axe comes in as a debugger's would. */
async function axeOn(page) {
  const session = await page.context().newCDPSession(page);
  await session.send('Runtime.evaluate', { expression: axe });
  // Style sheets and films are loaded again by rules that this page has no use for: no films, no rule for turned screens.
  return async () => {
    const { result } = await session.send('Runtime.evaluate', {
      expression: `axe.run(document, { resultTypes: ['violations'], preload: false })
        .then(found => JSON.stringify(found.violations.map(fault => fault.id + ': '
          + fault.nodes.map(node => node.target.flat().join(' ')).slice(0, 3).join(', '))))`,
      awaitPromise: true, returnByValue: true });
    return JSON.parse(result.value);
  };
}

/** Elements with text that is wider than they are and does not say so by an ellipsis; those for screen readers are 1 wide. */
function cutOff(page) {
  return page.evaluate(() => {
    const cut = [];
    const visit = root => {
      for (const element of root.querySelectorAll('*')) {
        if (element.shadowRoot) visit(element.shadowRoot);
        const style = getComputedStyle(element);
        const hasText = [...element.childNodes].some(node => node.nodeType === 3 && node.textContent.trim() !== '');
        const wider = element.scrollWidth > element.clientWidth + 1 && style.overflowX !== 'visible';
        const isField = element.tagName === 'INPUT' && element.type !== 'range' && element.type !== 'checkbox';
        const mayEnd = style.textOverflow === 'ellipsis' && element.dataset.testid !== 'hint';  // names of files may
        if ((hasText || isField) && wider && element.clientWidth > 1 && !mayEnd)
          cut.push(`${element.dataset.testid ?? element.tagName} "${(element.value ?? element.textContent).slice(0, 30)}"`);
      }
    };
    visit(document);
    return cut;
  });
}

/** Until the page is drawn and what moves has come to rest; what turns for ever does not count. */
function settled(page) {
  return page.evaluate(async () => {
    const frame = () => new Promise(resolve => requestAnimationFrame(resolve));
    await frame();
    await frame();
    const ending = document.getAnimations().filter(each => each.effect?.getComputedTiming().endTime !== Infinity);
    await Promise.allSettled(ending.map(each => each.finished));
    await frame();
  });
}

const tools = ['v', 'b', 'r', 'l', 'p', 'e', 'c', 'd', 'g', 'u', 'o', 'x', 'w'];
const panels = ['reconstruct', 'points', 'surface', 'problems', 'history'];

for (const [theme, width, height, ratio] of [['dark', 1280, 800, 1], ['light', 1280, 800, 1], ['dark', 1920, 1080, 2],
  ['light', 1920, 1080, 2]])
  test(`${theme}, ${width} by ${height}, ratio ${ratio}`, { skip: noBrowser(), timeout: 400_000 }, async () => {
    const studio = await Studio.open({ theme, width, height, ratio });
    const faults = await axeOn(studio.page);
    const found = [];
    const look = async what => {
      await settled(studio.page);
      for (const fault of await faults()) found.push(`${what}: ${fault}`);
      for (const text of await cutOff(studio.page)) found.push(`${what}: cut off: ${text}`);
      if (pictures && await pictureOf(studio.page)) await studio.page.screenshot({ path: join(pictures, `${theme}_${width}_${what}.png`) });
    };
    try {
      await look('empty');
      const since = studio.client.events.length;
      await studio.client.request('open', { files: [{ shape: 'torus', points: 4000 }], options: { depth: 6 } });
      await studio.drawn(since);
      for (const key of tools) {
        await studio.press(key);
        await look(`tool_${key}`);
      }
      await studio.press('v');
      for (const name of panels) {
        await panel(studio, name);
        await look(`panel_${name}`);
      }
      for (const [key, name, id] of [['Control+k', 'palette', 'palette'], ['Control+o', 'open', 'open-dialog'],
        ['Control+s', 'save', 'save-dialog'], ['?', 'keys', 'keys-dialog']]) {
        await studio.press(key);
        await studio.at(id).waitFor();
        await look(name);
        await studio.press('Escape');
        await studio.at(id).waitFor({ state: 'detached' });
      }
      assert.deepEqual([...new Set(found)], []);
      assert.deepEqual(studio.problems, []);
    } finally {
      await studio.close();
    }
  });
