import assert from "node:assert/strict";
import { test } from "node:test";
import type { GuideOperation, Operation } from "../../src/engine/protocol";
import { Previews } from "../../src/tools/shared/previews";
import { lookAt } from "./support";

interface Sent {
  verb: string;
  body: { operation?: Operation };
  reply(value: object): void;
  fail(error: Error): void;
}
function connection() {
  const sent: Sent[] = [];
  const request = (verb: string, body: object = {}) =>
    new Promise<object>((reply, fail) => sent.push({ verb, body, reply, fail }));
  return { sent, request };
}
const guide = (x: number): GuideOperation => ({ op: "guide", camera: lookAt([5, 0, 0], [0, 0, 0]), stroke: [[x, 0]] });
const settled = () => new Promise((resolve) => setTimeout(resolve));
const xOf = (sent: Sent) => (sent.body.operation as GuideOperation).stroke![0]![0];

test("one preview is under way, the newest waits, those between are dropped", async () => {
  const { sent, request } = connection();
  const previews = new Previews({ request }, () => undefined);
  for (const x of [1, 2, 3, 4]) previews.show(guide(x));
  assert.deepEqual(sent.map(xOf), [1]);
  sent[0]!.reply({});
  await settled();
  assert.deepEqual(sent.map(xOf), [1, 4]);
  sent[1]!.reply({});
  await settled();
  assert.equal(sent.length, 2);
});

test("what was superseded is no error, what failed is said once it is the newest", async () => {
  const { sent, request } = connection();
  const previews = new Previews({ request }, () => undefined);
  previews.show(guide(1));
  sent[0]!.fail(Object.assign(new Error("superseded"), { quiet: true }));
  await settled();
  assert.equal(previews.error, "");
  previews.show(guide(2));
  sent[1]!.fail(new Error("no point is inside"));
  await settled();
  assert.equal(previews.error, "no point is inside");
});

test("the end drops what waits and is told once", async () => {
  const { sent, request } = connection();
  const previews = new Previews({ request }, () => undefined);
  previews.end();
  assert.equal(sent.length, 0);
  previews.show(guide(1));
  previews.show(guide(2));
  previews.end();
  previews.end();
  sent[0]!.reply({});
  await settled();
  assert.deepEqual(sent.map((s) => s.verb), ["preview", "preview_end"]);
});

test("one commit at a time, and its record comes back", async () => {
  const { sent, request } = connection();
  const previews = new Previews({ request }, () => undefined);
  const first = previews.commit(guide(1));
  assert.equal(await previews.commit(guide(1)), null);
  assert.equal(sent.length, 1);
  sent[0]!.reply({ record: { operation: "guide", added: 12 } });
  assert.equal((await first)?.added, 12);
  const failed = previews.commit(guide(2));
  sent[1]!.fail(new Error("empty"));
  assert.equal(await failed, null);
  assert.equal(previews.error, "empty");
});
