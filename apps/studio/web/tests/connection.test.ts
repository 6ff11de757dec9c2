import assert from "node:assert/strict";
import { test } from "node:test";
import { Connection, type ConnectionState } from "../src/engine/connection";

/// A socket of the browser that the test opens, answers and closes.
class FakeSocket {
  static readonly OPEN = 1;
  static made: FakeSocket[] = [];
  readyState = FakeSocket.OPEN;
  onopen?: () => void;
  onmessage?: (event: { data: string }) => void;
  onclose?: () => void;
  constructor() {
    FakeSocket.made.push(this);
  }
  send(text: string): void {
    const { id } = JSON.parse(text) as { id: number };
    queueMicrotask(() => this.onmessage?.({ data: JSON.stringify({ id, ok: true }) }));
  }
  close(): void {
    this.onclose?.();
  }
}

const turn = () => new Promise((resolve) => setImmediate(resolve));

test("a page that the engine refuses says so, and goes on when another tab has signed in", async (t) => {
  t.mock.method(globalThis, "setTimeout", (run: () => void) => setImmediate(run));
  const before = globalThis.WebSocket;
  globalThis.WebSocket = FakeSocket as unknown as typeof WebSocket;
  try {
    let refused = false;
    const states: ConnectionState[] = [];
    const connection = new Connection("ws://here/socket", () => Promise.resolve(refused));
    connection.on("connection", (state) => states.push(state));
    connection.start();
    connection.start();
    assert.equal(FakeSocket.made.length, 1, "one socket at a time");
    FakeSocket.made[0]!.onopen?.();
    await turn();
    refused = true;
    FakeSocket.made[0]!.close();
    for (let i = 0; i < 4; ++i) await turn();
    assert.deepEqual(states, ["open", "lost", "refused"]);
    assert.equal(FakeSocket.made.length, 1, "no socket is tried that would be refused");
    refused = false;
    for (let i = 0; i < 4; ++i) await turn();
    FakeSocket.made[1]!.onopen?.();
    await turn();
    assert.deepEqual(states, ["open", "lost", "refused", "open"]);
    connection.stop();
  } finally {
    globalThis.WebSocket = before;
  }
});
