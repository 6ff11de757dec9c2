import "./page";
import assert from "node:assert/strict";
import { test } from "node:test";
import { tools } from "../../src/tools";
import { register } from "../../src/tools/registry";
import { Commands } from "../../src/ui/commands";
import { addCommands } from "../../src/app/command_list";
import type { StudioContext } from "../../src/app/context";
import type { Tool } from "../../src/tools/tool";
import { fakeContext, key } from "./fake_context";

function page() {
  const fake = fakeContext();
  const commands = new Commands();
  const made: Tool[] = tools.map((factory) => factory(fake.context));
  const chosen: string[] = [];
  const context = { ...fake.context, commands, tools: made, chooseTool: (id: string) => chosen.push(id) };
  addCommands(context as unknown as StudioContext);
  return { commands, made, chosen };
}

test("the tool bar has all tools, in this order and with these keys", () => {
  const { made } = page();
  const all = made.map((tool) => `${tool.key.toUpperCase()} ${tool.id}`);
  assert.deepEqual(all, [
    "V navigate", "B stroke", "R rectangle", "L lasso", "P polygon", "E erase", "C copyPart", "D bend", "G lattice",
    "U combine", "O orient", "X section", "W fluid",
  ]);
});

test("every key belongs to one command", () => {
  const { commands } = page();
  const keys = commands.search("").flatMap((command) => [command.key ?? "", ...(command.keys ?? [])]).filter(Boolean);
  const twice = keys.filter((name, i) => keys.indexOf(name) !== i);
  assert.deepEqual(twice, []);
});

test("the key of a tool chooses it", () => {
  const { commands, made, chosen } = page();
  for (const tool of made) {
    const event = key(tool.key, { code: `Key${tool.key.toUpperCase()}` });
    commands.byKey(event)?.run();
  }
  assert.deepEqual(chosen, made.map((tool) => tool.id));
});

test("every tool says in one line that fits the status bar what it does", () => {
  for (const tool of page().made.filter((t) => t.id !== "navigate")) {
    assert.ok(tool.hint.length > 20 && tool.hint.length <= 90, `${tool.id}: ${tool.hint.length}`);
    assert.match(tool.icon, /^M[-MmLlHhVvCcSsAaZzQqTt\d., ]+$/);
  }
});

test("a tool that is registered is in the bar, the palette and the keys", () => {
  register(() => ({ id: "measure", title: "Measure a length", key: "m", icon: "M4 12h16", hint: "Drag from one point to another" }));
  const { commands, made, chosen } = page();
  assert.equal(made[made.length - 1]!.id, "measure");
  assert.equal(commands.search("measure a length")[0]!.id, "tool-measure");
  commands.byKey(key("m", { code: "KeyM" }))?.run();
  assert.deepEqual(chosen, ["measure"]);
  tools.pop();
});
