// Requests for previews while a hand moves: one on its way, the newest waits, those between are dropped. And commits,
// one at a time.
import type { Operation, StepRecord } from "../../engine/protocol";

/// What previews need of a connection; Connection has it.
export interface Requests {
  request(verb: "preview" | "preview_end" | "apply", body?: object): Promise<object>;
}

function isQuiet(error: unknown): boolean {
  return (error as { quiet?: boolean }).quiet === true;
}

export class Previews {
  shown = false; // a preview was asked for and not ended
  committing = false;
  error = ""; // of the newest preview or commit, empty if it came
  told: Record<string, unknown> = {}; // what the reply to the newest preview said
  private running = false;
  private waiting: Operation | null = null;

  constructor(
    private readonly connection: Requests,
    private readonly changed: () => void,
  ) {}

  /// The newest preview has come and says that nothing would be added, removed or turned.
  get empty(): boolean {
    return !this.running && this.shown && this.error === "" && this.added === 0 && this.removed === 0;
  }
  /// Points that would be added, or turned round, and removed.
  get added(): number {
    return Number(this.told["added"] ?? 0);
  }
  get removed(): number {
    return Number(this.told["removed"] ?? 0);
  }

  show(operation: Operation): void {
    this.shown = true;
    this.waiting = operation;
    if (!this.running) void this.run();
  }

  private async run(): Promise<void> {
    this.running = true;
    while (this.waiting) {
      const operation = this.waiting;
      this.waiting = null;
      try {
        this.told = { ...(await this.connection.request("preview", { operation })) };
        this.error = "";
      } catch (error) {
        if (!isQuiet(error) && !this.waiting && this.shown) this.error = (error as Error).message;
      }
    }
    this.running = false;
    this.changed();
  }

  /// Back to the committed mesh, without ghosts. Nothing to do where no preview was asked for.
  end(): void {
    this.waiting = null;
    this.error = "";
    if (!this.shown) return;
    this.shown = false;
    this.connection.request("preview_end").catch(() => undefined);
  }

  /// Applies an operation, which ends its preview: the committed mesh takes its place. The record of what it did, or null where it failed, which `error` says, or another one is
  /// still under way.
  async commit(operation: Operation): Promise<StepRecord | null> {
    if (this.committing) return null;
    this.committing = true;
    this.waiting = null;
    this.shown = false;
    performance.mark("psk:commit");
    this.changed();
    try {
      const reply = (await this.connection.request("apply", { operation })) as { record: StepRecord };
      this.error = "";
      return reply.record;
    } catch (error) {
      if (!isQuiet(error)) this.error = (error as Error).message;
      this.shown = true; // the preview is still there
      return null;
    } finally {
      this.committing = false;
      this.changed();
    }
  }
}
