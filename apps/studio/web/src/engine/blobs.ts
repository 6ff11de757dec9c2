// The page's end of the decoding worker.
import type { Decoded } from "./blob";

interface Waiting {
  resolve(result: never): void;
  reject(error: Error): void;
}

export class Blobs {
  private readonly worker: Worker;
  private readonly waiting = new Map<number, Waiting>();
  private next = 1;

  constructor(url: string) {
    this.worker = new Worker(url, { type: "module" });
    this.worker.onmessage = (event: MessageEvent<{ id: number; result?: unknown; error?: string }>) => {
      const { id, result, error } = event.data;
      const waiting = this.waiting.get(id);
      this.waiting.delete(id);
      if (error !== undefined) waiting?.reject(new Error(error));
      else waiting?.resolve(result as never);
    };
  }

  load(blob: number): Promise<Decoded> {
    return this.ask({ url: `${location.origin}/blob/${blob}` }, []);
  }

  /// Index of the wireframe's lines.
  lines(triangles: Uint32Array): Promise<Uint32Array> {
    const copy = triangles.slice();
    return this.ask({ triangles: copy }, [copy.buffer]);
  }

  private ask<T>(message: object, transfer: Transferable[]): Promise<T> {
    const id = this.next++;
    this.worker.postMessage({ ...message, id }, transfer);
    return new Promise<T>((resolve, reject) => this.waiting.set(id, { resolve, reject } as Waiting));
  }
}
