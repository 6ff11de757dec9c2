import assert from "node:assert/strict";
import { test } from "node:test";
import { Commands, keyOf, normaliseKey, score } from "../src/ui/commands";

const event = (patch: object) => ({ key: "", code: "", ctrlKey: false, metaKey: false, altKey: false, shiftKey: false, ...patch });

test("a written key and a pressed one compare", () => {
  assert.equal(keyOf(event({ key: "Z", code: "KeyZ", ctrlKey: true, shiftKey: true })), normaliseKey("Ctrl+Shift+Z"));
  assert.equal(keyOf(event({ key: "k", code: "KeyK", metaKey: true })), normaliseKey("Ctrl+K"));
  assert.equal(keyOf(event({ key: "!", code: "Digit1", shiftKey: true })), normaliseKey("Shift+1"));
  assert.equal(keyOf(event({ key: "7", code: "Numpad7", ctrlKey: true })), normaliseKey("Ctrl+7"));
  assert.equal(keyOf(event({ key: "?", code: "Slash", shiftKey: true })), normaliseKey("?"));
  assert.equal(keyOf(event({ key: "Escape", code: "Escape" })), normaliseKey("Escape"));
  assert.notEqual(keyOf(event({ key: "f", code: "KeyF", shiftKey: true })), normaliseKey("F"));
});

test("a query fits by its words, then by its letters in order", () => {
  assert.ok(score("view", "View from the top") > score("view", "Picture of the view"));
  assert.ok(score("vft", "View from the top") > 0);
  assert.ok(score("top", "View from the top") > score("top", "Stroke by a topology"));
  assert.equal(score("xq", "View from the top"), 0);
  assert.ok(score("", "anything") > 0);
});

test("the palette finds the best first and runs what can be run", () => {
  const commands = new Commands();
  const ran: string[] = [];
  const add = (id: string, title: string, enabled = true) => commands.add({ id, title, run: () => void ran.push(id), enabled: () => enabled });
  add("frame", "Frame all");
  add("undo", "Undo", false);
  add("wire", "Wireframe");
  assert.deepEqual(commands.search("frame").map((c) => c.id), ["frame", "wire"]);
  assert.equal(commands.search("").length, 3);
  assert.equal(commands.run("frame"), true);
  assert.equal(commands.run("undo"), false);
  assert.equal(commands.run("nothing"), false);
  assert.deepEqual(ran, ["frame"]);
});

test("a key runs the command that has it, also by a second key", () => {
  const commands = new Commands();
  commands.add({ id: "redo", title: "Redo", key: "Ctrl+Shift+Z", keys: ["Ctrl+Y"], run: () => undefined });
  assert.equal(commands.byKey(event({ key: "y", code: "KeyY", ctrlKey: true }) as KeyboardEvent)?.id, "redo");
  assert.equal(commands.byKey(event({ key: "y", code: "KeyY" }) as KeyboardEvent), undefined);
});
