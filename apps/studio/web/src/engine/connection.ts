// The page's end of the WebSocket: requests with replies, events, and reconnecting with back-off.
import type { EventName, Events, Hello, Reply, Verb } from "./protocol";

/// refused: there is an engine, and it does not know this page; it may have been started again.
export type ConnectionState = "connecting" | "open" | "lost" | "refused";

/// An error reply. `code` is the engine's name for it; "superseded" and "interrupted" are no mistakes of anyone.
export class EngineError extends Error {
  constructor(
    readonly code: string,
    text: string,
  ) {
    super(text);
  }
  get quiet(): boolean {
    return this.code === "superseded" || this.code === "interrupted";
  }
}

/// Milliseconds before attempt n (from 0): 250 ms, doubled each time, 8 s at most.
export function backOff(attempt: number): number {
  return Math.min(250 * 2 ** attempt, 8000);
}

type Listener = (data: never) => void;
interface Pending {
  resolve(reply: never): void;
  reject(error: EngineError): void;
}

export class Connection {
  state: ConnectionState = "connecting";
  private socket: WebSocket | null = null;
  private nextId = 1;
  private attempt = 0;
  private closed = false;
  private readonly pending = new Map<number, Pending>();
  private readonly listeners = new Map<string, Set<Listener>>();

  /// @param refused  asked before each new attempt: whether the engine would not let this page in
  constructor(
    private readonly url: string,
    private readonly refused: () => Promise<boolean> = () => Promise.resolve(false),
  ) {}

  /// Opens the socket, and again whenever it is lost. Nothing to do while there is one.
  start(): void {
    if (this.socket || this.closed) return;
    const socket = new WebSocket(this.url);
    this.socket = socket;
    socket.onopen = () => void this.greet();
    socket.onmessage = (event) => this.receive(String(event.data));
    socket.onclose = () => this.lost();
  }

  stop(): void {
    this.closed = true;
    this.socket?.close();
  }

  /// Sends a request. Rejects with EngineError, also when the connection goes before the reply.
  request<V extends Verb>(verb: V, body: object = {}): Promise<Reply<V>> {
    const socket = this.socket;
    if (!socket || socket.readyState !== WebSocket.OPEN) {
      return Promise.reject(new EngineError("lost", "The connection to the engine is lost"));
    }
    const id = this.nextId++;
    socket.send(JSON.stringify({ ...body, id, do: verb }));
    return new Promise((resolve, reject) => this.pending.set(id, { resolve, reject } as Pending));
  }

  /// Listens for an event, or for the page's own "hello" (after each connect) and "connection" (its state changed).
  on<E extends EventName>(event: E, listener: (data: Events[E]) => void): () => void;
  on(event: "hello", listener: (data: Hello) => void): () => void;
  on(event: "connection", listener: (state: ConnectionState) => void): () => void;
  on(event: string, listener: (data: never) => void): () => void {
    const set = this.listeners.get(event) ?? new Set<Listener>();
    this.listeners.set(event, set);
    set.add(listener);
    return () => set.delete(listener);
  }

  /// Calls `listener` now if the connection is open, and after each connect from now on. @returns what ends that
  whenOpen(listener: () => void): () => void {
    if (this.state === "open") listener();
    return this.on("hello", listener);
  }

  private async greet(): Promise<void> {
    try {
      const hello = await this.request("hello");
      this.attempt = 0;
      this.become("open");
      this.emit("hello", hello);
    } catch {
      this.socket?.close();
    }
  }

  private receive(text: string): void {
    const message = JSON.parse(text) as Record<string, unknown>;
    if (typeof message["event"] === "string") {
      this.emit(message["event"], message);
      return;
    }
    const id = Number(message["id"]);
    const pending = this.pending.get(id);
    this.pending.delete(id);
    const error = message["error"] as { code: string; text: string } | undefined;
    if (error) {
      pending?.reject(new EngineError(error.code, error.text));
    } else {
      pending?.resolve(message as never);
    }
  }

  private lost(): void {
    for (const pending of this.pending.values()) {
      pending.reject(new EngineError("lost", "The connection to the engine is lost"));
    }
    this.pending.clear();
    this.socket = null;
    if (this.closed) return;
    this.become(this.state === "refused" ? "refused" : "lost");
    this.later();
  }

  private later(): void {
    setTimeout(() => void this.again(), backOff(this.attempt++));
  }

  /// Goes on asking while it is refused: another tab may sign in for all.
  private async again(): Promise<void> {
    if (this.socket || this.closed) return;
    if (!(await this.refused())) return this.start();
    this.become("refused");
    this.later();
  }

  private become(state: ConnectionState): void {
    if (this.state === state) return;
    this.state = state;
    this.emit("connection", state);
  }

  private emit(event: string, data: unknown): void {
    for (const listener of this.listeners.get(event) ?? []) {
      listener(data as never);
    }
  }
}
