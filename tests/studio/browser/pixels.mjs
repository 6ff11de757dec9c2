// Pictures as pixels: where something is drawn, and that something is.
import { require } from './packages.mjs';

const { PNG } = require('pngjs');

/** @param {Buffer} png @returns {{width, height, at(x, y): [r, g, b]}} */
export function decode(png) {
  const { width, height, data } = PNG.sync.read(png);
  return { width, height, at: (x, y) => [...data.subarray(4 * (y * width + x), 4 * (y * width + x) + 3)] };
}

const distance = (a, b) => Math.max(...a.map((value, i) => Math.abs(value - b[i])));

/**
 * The box around all pixels of `picture` that differ from those of `before` by more than `least`, or null. Only those
 * that are in the picture `like` what they are in `picture`, if it is given.
 */
export function changedBox(picture, before, { least = 12, like = picture } = {}) {
  const changed = (x, y) => distance(picture.at(x, y), before.at(x, y)) > least
    && distance(picture.at(x, y), like.at(x, y)) <= least;
  const box = { left: Infinity, top: Infinity, right: -1, bottom: -1, pixels: 0 };
  for (let y = 0; y < picture.height; y += 1)
    for (let x = 0; x < picture.width; x += 1)
      if (changed(x, y)) {
        box.left = Math.min(box.left, x);
        box.right = Math.max(box.right, x);
        box.top = Math.min(box.top, y);
        box.bottom = Math.max(box.bottom, y);
        box.pixels += 1;
      }
  return box.pixels ? box : null;
}

/** How many different colours a picture has, a canvas that is blank having one. */
export function colours(picture) {
  const seen = new Set();
  for (let y = 0; y < picture.height; y += 3)
    for (let x = 0; x < picture.width; x += 3) seen.add(picture.at(x, y).join());
  return seen.size;
}
