import assert from "node:assert/strict";
import { test } from "node:test";
import { kMapShader, mapColour } from "../src/view/colours";

/// Lightness of OKLab (Ottosson 2020) of sRGB in [0, 1].
function lightness(colour: [number, number, number]): number {
  const [r, g, b] = colour.map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)) as [number, number, number];
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return 0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s;
}

test("lightness rises evenly over the map", () => {
  const steps = Array.from({ length: 21 }, (_, i) => lightness(mapColour(i / 20)));
  for (let i = 1; i < steps.length; ++i) {
    const rise = steps[i]! - steps[i - 1]!;
    assert.ok(rise > 0.012 && rise < 0.04, `step ${i}: ${rise}`);
  }
});

test("the map goes from blue to orange, and no further", () => {
  const [r, , b] = mapColour(0);
  assert.ok(b > r + 0.2);
  const [r1, g1, b1] = mapColour(1);
  assert.ok(r1 > b1 + 0.3 && g1 > b1);
  assert.deepEqual(mapColour(7), mapColour(1));
  assert.deepEqual(mapColour(NaN), mapColour(0));
});

test("the shader has the same coefficients", () => {
  const flat = [...kMapShader.matchAll(/vec3\(([-\d.]+),([-\d.]+),([-\d.]+)\)/g)].map((m) => m.slice(1).map(Number));
  const at = (x: number) => [0, 1, 2].map((k) => flat.reduceRight((sum, c) => sum * x + c[k]!, 0));
  for (const x of [0, 0.3, 0.8]) {
    at(x).forEach((value, k) => assert.ok(Math.abs(Math.min(Math.max(value, 0), 1) - mapColour(x)[k]!) < 1e-9));
  }
});
