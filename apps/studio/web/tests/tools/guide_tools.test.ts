import "./page";
import assert from "node:assert/strict";
import { test } from "node:test";
import type { GuideOperation, Pixel, RemoveOperation } from "../../src/engine/protocol";
import { erase } from "../../src/tools/erase";
import { lasso } from "../../src/tools/lasso";
import { orientTool } from "../../src/tools/orient";
import { polygon } from "../../src/tools/polygon";
import { rectangle } from "../../src/tools/rectangle";
import { stroke } from "../../src/tools/stroke";
import type { Tool, ToolPointer } from "../../src/tools/tool";
import { fakeContext, key, pointer, settled } from "./fake_context";
import { lookAt } from "./support";

function drag(tool: Tool, points: Pixel[], more: Partial<ToolPointer> = {}): void {
  const [first, ...rest] = points;
  assert.ok(tool.pointerDown!(pointer(...first!, more)));
  for (const p of rest) tool.pointerMove!(pointer(...p, more));
  tool.pointerUp!(pointer(...points[points.length - 1]!, more));
}
const square = (x: number, side: number): Pixel[] => [[x, x], [x + side, x], [x + side, x + side], [x, x + side]];

test("a stroke is previewed when it ends, and Enter applies what was previewed", async () => {
  const { context, sent } = fakeContext();
  const tool = stroke(context);
  drag(tool, [[100, 100], [200, 100], [200, 180]]);
  await settled();
  assert.deepEqual(sent.map((s) => s.verb), ["preview"]);
  assert.deepEqual((sent[0]!.body.operation as GuideOperation).stroke, [[100, 100], [200, 100], [200, 180]]);
  assert.ok(tool.keyDown!(key("Enter")));
  await settled();
  assert.deepEqual(sent.map((s) => s.verb), ["preview", "apply"]);
  assert.deepEqual(sent[1]!.body.operation, sent[0]!.body.operation);
  assert.ok(!tool.keyDown!(key("Enter")), "there is nothing left to apply");
});

test("Esc drops the shape and its preview", async () => {
  const { context, sent } = fakeContext();
  const tool = rectangle(context);
  drag(tool, [[100, 100], [200, 180]]);
  await settled();
  assert.ok(tool.keyDown!(key("Escape")));
  assert.deepEqual(sent.map((s) => s.verb), ["preview", "preview_end"]);
  assert.ok(!tool.keyDown!(key("Escape")));
});

test("a shape that failed stays, so that it can be mended", async () => {
  const { context, sent, notices, view } = fakeContext();
  const tool = rectangle(context);
  view.replies["apply"] = new Error("no point would be left");
  drag(tool, [[100, 100], [200, 180]]);
  tool.keyDown!(key("Enter"));
  await settled();
  assert.deepEqual(notices, ["no point would be left"]);
  delete view.replies["apply"];
  tool.keyDown!(key("Enter"));
  await settled();
  assert.equal(sent.filter((s) => s.verb === "apply").length, 2);
});

test("what would change nothing is not applied", async () => {
  const { context, sent, notices, view } = fakeContext();
  view.replies["preview"] = { added: 0, removed: 0 };
  const tool = erase(context);
  drag(tool, [[100, 100], [200, 180]]);
  await settled();
  tool.keyDown!(key("Enter"));
  await settled();
  assert.deepEqual([sent.map((s) => s.verb), notices.length], [["preview"], 1]);
});

test("the next shape is drawn while the last one is being applied", async () => {
  const { context, sent } = fakeContext();
  const tool = rectangle(context);
  drag(tool, [[100, 100], [200, 180]]);
  await settled();
  tool.keyDown!(key("Enter"));
  drag(tool, [[300, 100], [400, 180]]);
  await settled();
  assert.ok(tool.keyDown!(key("Enter")));
  await settled();
  const applied = sent.filter((s) => s.verb === "apply").map((s) => (s.body.operation as GuideOperation).rectangle);
  assert.deepEqual(applied, [[100, 100, 200, 180], [300, 100, 400, 180]]);
});

test("brackets change the interval of all guide tools and preview anew", async () => {
  const { context, sent } = fakeContext();
  const tool = stroke(context);
  drag(tool, [[100, 100], [200, 100]]);
  await settled();
  for (let i = 0; i < 4; ++i) tool.keyDown!(key("]"));
  await settled();
  const cell = (1.1 * 2) / 32;
  const intervals = sent.map((s) => (s.body.operation as GuideOperation).interval!);
  assert.equal(intervals[0], 0);
  assert.ok(Math.abs(intervals[intervals.length - 1]! - 2 * cell) < 1e-12);
  const other = lasso(context);
  drag(other, square(100, 80));
  await settled();
  assert.ok(Math.abs((sent[sent.length - 1]!.body.operation as GuideOperation).interval! - 2 * cell) < 1e-12);
});

test("corners of a rectangle can be dragged, and the preview follows", async () => {
  const { context, sent } = fakeContext();
  const tool = rectangle(context);
  drag(tool, [[100, 100], [200, 180]]);
  await settled();
  drag(tool, [[201, 181], [260, 250]]);
  await settled();
  assert.deepEqual((sent[sent.length - 1]!.body.operation as GuideOperation).rectangle, [100, 100, 260, 250]);
});

test("Alt adds a loop to a lasso, but not to one that was drawn from elsewhere", async () => {
  const { context, sent, view } = fakeContext();
  const tool = lasso(context);
  const loops = () => (sent[sent.length - 1]!.body.operation as GuideOperation).area!.length;
  drag(tool, square(100, 200));
  await settled();
  drag(tool, square(150, 50), { alt: true });
  await settled();
  assert.equal(loops(), 2);
  view.camera = lookAt([5, -4, 4], [1, 1, 1]);
  drag(tool, square(150, 50), { alt: true });
  await settled();
  assert.equal(loops(), 1);
  assert.deepEqual((sent[sent.length - 1]!.body.operation as GuideOperation).camera, view.camera);
});

test("the first Enter closes a polygon, the second applies it", async () => {
  const { context, sent } = fakeContext();
  const tool = polygon(context);
  for (const p of square(100, 90)) drag(tool, [p]);
  assert.ok(tool.keyDown!(key("Enter")));
  await settled();
  assert.deepEqual(sent.map((s) => s.verb), ["preview"]);
  assert.ok(tool.keyDown!(key("Enter")));
  await settled();
  assert.deepEqual(sent.map((s) => s.verb), ["preview", "apply"]);
  assert.deepEqual((sent[1]!.body.operation as GuideOperation).area, [square(100, 90)]);
});

test("erasing takes added points, and with Shift all", async () => {
  const { context, sent } = fakeContext();
  const tool = erase(context);
  const last = () => sent[sent.length - 1]!.body.operation as RemoveOperation;
  drag(tool, [[100, 100], [200, 180]]);
  await settled();
  assert.deepEqual([last().op, last().originals, last().layers], ["remove", false, "through"]);
  drag(tool, [[300, 100], [400, 180]], { shift: true });
  await settled();
  assert.deepEqual([last().originals, last().rectangle], [true, [300, 100, 400, 180]]);
  drag(tool, [[100, 300], [200, 380]]);
  await settled();
  assert.equal(last().originals, false);
});

test("an area of the orient tool turns normals", async () => {
  const { context, sent } = fakeContext();
  const tool = orientTool(context);
  drag(tool, [[100, 100], [200, 180]]);
  await settled();
  assert.equal(sent[0]!.body.operation!.op, "flip");
});

test("without a scene the view moves instead", () => {
  const { context, store } = fakeContext();
  store.scene = null;
  assert.equal(stroke(context).pointerDown!(pointer(10, 10)), false);
});

test("another button is not the tool's", () => {
  const { context } = fakeContext();
  assert.equal(stroke(context).pointerDown!(pointer(10, 10, { button: 1 })), false);
});

test("a tool put away leaves no preview behind", async () => {
  const { context, sent } = fakeContext();
  const tool = rectangle(context);
  drag(tool, [[100, 100], [200, 180]]);
  await settled();
  tool.deactivate!();
  assert.equal(sent[sent.length - 1]!.verb, "preview_end");
});
