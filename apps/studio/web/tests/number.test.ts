import assert from "node:assert/strict";
import { test } from "node:test";
import { clampNumber, dragNumber, fitNumber, parseNumber, showNumber } from "../src/ui/number_field";
import { bytes, count, duration, measure, percent, shortCount, signed } from "../src/ui/format";

const kDepth = { min: 5, max: 14, step: 1 };

test("numbers are limited and snapped without the noise of sums", () => {
  assert.equal(clampNumber(20, kDepth), 14);
  assert.equal(clampNumber(7.6, kDepth), 8);
  assert.equal(clampNumber(0.1 + 0.2, { min: 0, max: 1, step: 0.1 }), 0.3);
  assert.equal(clampNumber(3.14159, { min: -Infinity, max: Infinity, step: 0 }), 3.14159);
});

test("what is typed is read with commas, spaces, products and quotients", () => {
  assert.equal(parseNumber("1,5"), 1.5);
  assert.equal(parseNumber(" 1 000 "), 1000);
  assert.equal(parseNumber("1/4"), 0.25);
  assert.equal(parseNumber("2*3"), 6);
  assert.equal(parseNumber("−2e-3"), -0.002);
  assert.equal(parseNumber("abc"), null);
  assert.equal(parseNumber("1/0"), null);
});

test("dragging moves by a step for four pixels, a tenth of that with Shift", () => {
  assert.equal(dragNumber(8, 8, kDepth, false), 10);
  assert.equal(dragNumber(8, -400, kDepth, false), 5);
  assert.equal(dragNumber(8, 40, kDepth, true), 9);
  assert.equal(dragNumber(2, 100, { min: 0, max: 10, step: 0 }, false), 3);
});

test("a field shows six digits at most", () => {
  assert.equal(showNumber(1 / 3), "0.333333");
  assert.equal(showNumber(NaN), "");
  assert.equal(fitNumber(0.25024, 6), "0.2502");
  assert.equal(fitNumber(-0.123456, 5), "-0.12");
  assert.equal(fitNumber(20000, 3), "20000");
  assert.equal(fitNumber(NaN, 6), "");
});

test("counts, sizes and times read well", () => {
  assert.equal(count(1204567), "1,204,567");
  assert.equal(count(999), "999");
  assert.equal(count(NaN), "–");
  assert.equal(shortCount(1204), "1.2 k");
  assert.equal(shortCount(999_999), "1.0 M");
  assert.equal(signed(-12), "−12");
  assert.equal(signed(1204), "+1,204");
  assert.equal(bytes(512), "512 bytes");
  assert.equal(bytes(4_221_345), "4.2 MB");
  assert.equal(duration(0.44), "0.4 ms");
  assert.equal(duration(38), "38 ms");
  assert.equal(duration(1234), "1.2 s");
  assert.equal(duration(125_000), "2 min 5 s");
  assert.equal(duration(59_960), "1 min 0 s");
  assert.equal(percent(0.085), "8.5 %");
  assert.equal(measure(0), "0");
  assert.equal(measure(0.00123456), "0.001235");
  assert.equal(measure(5_400_000.5), "5400000.5");
  assert.equal(measure(3e-7), "3.00e-7");
});
