// What bending by handles and by a lattice have in common: previews while something is dragged, one drag one step of
// the history, and undo that brings the handles back.
import type { SVGTemplateResult, TemplateResult } from "lit";
import type { DeformOperation } from "../../engine/protocol";
import type { Tool, ToolContext } from "../tool";
import { Previews } from "./previews";
import { Snapshots } from "./snapshots";

/// @tparam T  what undo brings back; never changed in place
export abstract class DeformTool<T> implements Tool {
  abstract readonly id: string;
  abstract readonly title: string;
  abstract readonly key: string;
  abstract readonly icon: string;
  abstract readonly hint: string;
  abstract settings(): TemplateResult;
  abstract overlay(): SVGTemplateResult;

  protected readonly previews: Previews;
  /// Each drag is applied when it ends; else Enter applies what all of them make.
  protected eachDrag = true;
  private readonly snapshots = new Snapshots<T>();
  private readonly watch = () => this.historyMoved();
  private clouds = "";
  private mesh: unknown = null;

  constructor(protected readonly context: ToolContext) {
    this.previews = new Previews(context.connection, () => context.redraw());
  }

  /// What is dragged now; null: nothing is moved.
  protected abstract operation(): DeformOperation | null;
  protected abstract get state(): T;
  protected abstract set state(state: T);
  /// The state after the present operation was applied: what was moved is where it is now.
  protected abstract settled(): T;
  /// Everything back to where it was before the drags that are not applied.
  protected abstract reset(): void;
  /// Another scene.
  protected abstract forget(): void;

  activate(): void {
    this.context.store.addEventListener("change", this.watch);
    this.historyMoved();
  }

  deactivate(): void {
    this.context.store.removeEventListener("change", this.watch);
    this.drop();
  }

  private historyMoved(): void {
    const { scene } = this.context.store;
    const clouds = (scene?.clouds ?? []).map((cloud) => cloud.name).join("\n");
    if (clouds !== this.clouds) {
      this.clouds = clouds;
      this.snapshots.clear();
      this.forget();
    }
    if (this.context.store.mesh !== this.mesh) {
      this.mesh = this.context.store.mesh;
      this.meshChanged();
    }
    const state = scene ? this.snapshots.arrive(scene.done) : null;
    if (!state || this.previews.committing) return;
    this.state = state;
    this.context.redraw();
  }

  /// Another mesh is on the screen.
  protected meshChanged(): void {}

  protected get pending(): boolean {
    return this.operation() !== null;
  }

  protected preview(): void {
    const operation = this.operation();
    if (operation) this.previews.show(operation);
    this.context.redraw();
  }

  protected released(): void {
    if (this.eachDrag) void this.commit();
  }

  protected async commit(): Promise<void> {
    const operation = this.operation();
    const done = this.context.store.scene?.done;
    if (!operation || done === undefined || this.previews.committing) return;
    const [before, after] = [this.restState(), this.settled()];
    this.snapshots.step(done, before, after);
    const record = await this.previews.commit(operation);
    if (record) {
      this.state = after;
    } else {
      if (this.previews.error) this.context.notice("error", this.previews.error);
      this.drop();
    }
    this.context.redraw();
  }

  /// The state without what is not applied.
  private restState(): T {
    const now = this.state;
    this.reset();
    const rest = this.state;
    this.state = now;
    return rest;
  }

  protected drop(): void {
    this.reset();
    this.previews.end();
    this.context.redraw();
  }

  keyDown(e: KeyboardEvent): boolean {
    if (e.key === "Enter" && this.pending) void this.commit();
    else if (e.key === "Escape" && this.pending) this.drop();
    else return false;
    return true;
  }
}
