// Options that follow the hand: previews while a control moves, the real thing when it rests. One drag is one step of
// history, so that a pause of the hand in the middle of it commits nothing.
import type { Connection } from "../engine/connection";
import { EngineError } from "../engine/connection";
import type { Options } from "../engine/protocol";
import type { Level, Store } from "../engine/store";

const kRest = 150; // milliseconds after the last change, so that keys held down are one step as well

export class LiveOptions {
  private timer = 0;
  private frame = 0;
  private sending = false;
  private moving = false; // between the first input and the change that ends it

  constructor(
    private readonly connection: Connection,
    private readonly store: Store,
    private readonly notice: (level: Level, text: string) => void,
  ) {}

  get active(): boolean {
    return this.store.pendingOptions !== null;
  }

  /// A control moves.
  input(patch: Options): void {
    this.merge(patch);
    this.moving = true;
    clearTimeout(this.timer);
    if (!this.frame) this.frame = requestAnimationFrame(() => void this.preview());
  }

  /// A control moves whose effect the page shows by itself.
  hold(patch: Options): void {
    this.merge(patch);
    this.moving = false;
    clearTimeout(this.timer);
  }

  /// A control rests.
  change(patch: Options): void {
    this.merge(patch);
    this.moving = false;
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.commit(), kRest);
  }

  /// Back to what is applied. @returns false if nothing was pending
  cancel(): boolean {
    if (!this.active) return false;
    this.goBack();
    return true;
  }

  private merge(patch: Options): void {
    this.store.update({ pendingOptions: { ...this.store.pendingOptions, ...patch } });
  }

  /// The committed surface again, without what was shown while the hand moved.
  private goBack(): void {
    const trimmed = this.store.pendingOptions?.trim !== undefined;
    this.drop();
    if (!this.store.scene) return;
    void this.connection.request("preview_end").catch(() => undefined);
    if (trimmed) void this.connection.request("values_end").catch(() => undefined);
  }

  private drop(): void {
    this.moving = false;
    clearTimeout(this.timer);
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.store.update({ pendingOptions: null });
  }

  private async preview(): Promise<void> {
    this.frame = 0;
    const patch = this.store.pendingOptions;
    if (!patch || !this.moving || !this.store.scene || this.sending) return;
    this.sending = true;
    await this.send(patch, false);
    this.sending = false;
    // What moved meanwhile, once more, so that the last place is seen as well.
    if (this.store.pendingOptions && this.store.pendingOptions !== patch) void this.preview();
  }

  private async commit(): Promise<void> {
    const patch = this.store.pendingOptions;
    if (!patch) return;
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    const applied = this.store.scene?.options ?? {};
    const same = Object.entries(patch).every(([key, value]) => applied[key] === value);
    if (same || !this.store.scene) return this.goBack();
    await this.send(patch, true);
    if (this.store.pendingOptions === patch) this.drop();
  }

  private async send(patch: Options, final: boolean): Promise<void> {
    try {
      await this.connection.request("options", { patch, final });
    } catch (error) {
      if (error instanceof EngineError && (error.quiet || error.code === "lost")) return;
      this.notice("error", (error as Error).message);
      if (final) this.goBack();
    }
  }
}
