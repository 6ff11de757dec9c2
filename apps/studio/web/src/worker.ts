// Fetches blobs and decodes them off the page's thread.
import { buffersOf, decodeBlob, linesOf } from "./engine/blob";
import { readAll } from "./engine/stream";

export type WorkerRequest = { id: number; url: string } | { id: number; triangles: Uint32Array };

interface Port {
  onmessage: ((event: MessageEvent<WorkerRequest>) => void) | null;
  postMessage(message: unknown, transfer: Transferable[]): void;
}
const port = self as unknown as Port;

async function load(url: string) {
  const begun = performance.now();
  const bytes = await readAll(await fetch(url, { credentials: "same-origin" }));
  const fetched = performance.now();
  const decoded = await decodeBlob(bytes);
  decoded.transferMs = fetched - begun;
  decoded.decodeMs = performance.now() - fetched;
  return decoded;
}

async function answer(request: WorkerRequest): Promise<void> {
  try {
    if ("triangles" in request) {
      const lines = linesOf(request.triangles);
      port.postMessage({ id: request.id, result: lines }, [lines.buffer]);
      return;
    }
    const decoded = await load(request.url);
    port.postMessage({ id: request.id, result: decoded }, buffersOf(decoded));
  } catch (error) {
    port.postMessage({ id: request.id, error: String((error as Error).message) }, []);
  }
}

port.onmessage = (event) => void answer(event.data);
