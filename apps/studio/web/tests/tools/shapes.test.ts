import assert from "node:assert/strict";
import { test } from "node:test";
import type { Pixel } from "../../src/engine/protocol";
import { closeLoop, isInside, kMostPoints, oriented, signedArea, simplify, simplifyLoop, tidyLoop } from "../../src/tools/shared/shapes";

const square = (at: number, side: number): Pixel[] => [[at, at], [at + side, at], [at + side, at + side], [at, at + side]];

function distanceTo(line: Pixel[], [x, y]: Pixel): number {
  let best = Infinity;
  for (let i = 0; i + 1 < line.length; ++i) {
    const [a, b] = [line[i]!, line[i + 1]!];
    const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    const t = Math.max(0, Math.min(1, ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy || 1)));
    best = Math.min(best, Math.hypot(x - a[0] - t * dx, y - a[1] - t * dy));
  }
  return best;
}

test("a straight stroke keeps its ends alone", () => {
  const line = Array.from({ length: 200 }, (_, i): Pixel => [i, 2 * i]);
  assert.deepEqual(simplify(line), [[0, 0], [199, 398]]);
});

test("a simplified stroke runs within half a pixel of the drawn one", () => {
  const wave = Array.from({ length: 700 }, (_, i): Pixel => [i, 60 * Math.sin(i / 25)]);
  const kept = simplify(wave);
  assert.ok(kept.length < 250 && kept.length > 20, `${kept.length}`);
  assert.ok(wave.every((p) => distanceTo(kept, p) <= 0.5 + 1e-9));
});

test("no stroke keeps more than 500 points, however it trembles", () => {
  const wild = Array.from({ length: 6000 }, (_, i): Pixel => [i / 3, i % 2 === 0 ? 0 : 100 + (i % 7)]);
  const kept = simplify(wild);
  assert.ok(kept.length <= kMostPoints);
  assert.deepEqual([kept[0], kept[kept.length - 1]], [wild[0], wild[5999]]);
  assert.ok(simplifyLoop(wild).length <= kMostPoints);
});

test("a loop is closed without its first point again", () => {
  assert.deepEqual(closeLoop([[0, 0], [0, 0], [5, 0], [5, 5], [0, 0], [0, 0]]), [[0, 0], [5, 0], [5, 5]]);
});

test("a round loop keeps its area to a percent", () => {
  const circle = Array.from({ length: 600 }, (_, i): Pixel => [100 * Math.cos(i / 95.49), 100 * Math.sin(i / 95.49)]);
  const kept = simplifyLoop(circle);
  assert.ok(kept.length < 80);
  assert.ok(Math.abs(Math.abs(signedArea(kept)) / (Math.PI * 1e4) - 1) < 0.01);
});

test("loops are clockwise on the screen whichever way they were drawn", () => {
  const loop = square(0, 10);
  assert.equal(signedArea(loop), 100);
  assert.equal(signedArea(oriented([...loop].reverse())), 100);
  assert.deepEqual(oriented(loop), loop);
});

test("a loop in a loop is a hole, and one in that is filled again", () => {
  const area = [square(0, 100), square(20, 60), square(40, 20)];
  assert.ok(isInside(area, [10, 10]));
  assert.ok(!isInside(area, [30, 30]));
  assert.ok(isInside(area, [50, 50]));
  assert.ok(!isInside(area, [150, 50]));
});

test("a slip of the hand encloses nothing", () => {
  assert.equal(tidyLoop([[5, 5], [6, 5], [6, 6]]), null);
  assert.equal(tidyLoop([[5, 5], [50, 5]]), null);
  assert.ok(tidyLoop(square(0, 5)));
});
