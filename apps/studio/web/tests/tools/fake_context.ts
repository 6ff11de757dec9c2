// A context for tools without a page or an engine: requests are kept and answered, the view is a fixed camera.
import type { Box, CameraJson, Operation, SceneState } from "../../src/engine/protocol";
import { Store } from "../../src/engine/store";
import type { Pick, ToolContext, ToolPointer } from "../../src/tools/tool";
import { lookAt } from "./support";

export interface Sent {
  verb: string;
  body: { operation?: Operation } & Record<string, unknown>;
}
const box: Box = { lower: [0, 0, 0], upper: [2, 2, 2] };

export function fakeContext() {
  const sent: Sent[] = [];
  const notices: string[] = [];
  const store = new Store();
  const cloud = { name: "c", points: 9, normals: true, box, shift: [0, 0, 0], dropped: 0 };
  store.scene = { clouds: [cloud], options: { depth: 5 }, history: [], done: 0, points: 9, topology: null, base_label: "" } as unknown as SceneState;
  const view = { camera: lookAt([5, -4, 3], [1, 1, 1]), replies: {} as Record<string, object | Error>, section: null as unknown };
  const connection = {
    request: (verb: string, body: Sent["body"] = {}) => {
      sent.push({ verb, body });
      const reply = view.replies[verb] ?? { added: 5, removed: 5, record: { operation: "x", notes: [] } };
      return reply instanceof Error ? Promise.reject(reply) : Promise.resolve(reply);
    },
  };
  const viewport = {
    box,
    still: true,
    ghosts: { group: { children: [] } },
    cameraDocument: (): CameraJson => structuredClone(view.camera),
    setGhosts: () => undefined,
    setSection: (section: unknown) => void (view.section = section),
    frame: () => undefined,
  };
  const context = {
    connection,
    store,
    viewport,
    redraw: () => undefined,
    notice: (_: string, text: string) => void notices.push(text),
    run: () => undefined,
  } as unknown as ToolContext;
  return { context, sent, notices, store, view };
}

export function pointer(x: number, y: number, more: Partial<ToolPointer> & { hit?: Pick } = {}): ToolPointer {
  const base = { x, y, buttons: 1, button: 0, shift: false, ctrl: false, alt: false, pressure: 0.5, pointerType: "mouse" };
  return { ...base, pick: () => more.hit ?? null, ...more };
}

export function key(name: string, more: Partial<KeyboardEvent> = {}): KeyboardEvent {
  return { key: name, shiftKey: false, ctrlKey: false, metaKey: false, altKey: false, ...more } as KeyboardEvent;
}

/// Replies that are under way arrive.
export const settled = () => new Promise((resolve) => setTimeout(resolve));
