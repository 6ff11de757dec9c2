// What tools have in common that bring a second cloud or solid into the scene and place it by a gizmo. The part is
// measured first, by a preview of it where it lies by itself; then it is put beside or into the scene.
import { type SVGTemplateResult, type TemplateResult, nothing, svg } from "lit";
import type { Box, FileKind, InsertOperation, Operation, Vec3 } from "../../engine/protocol";
import type { Tool, ToolContext, ToolPointer } from "../tool";
import type { Source } from "./documents";
import { boxOfLayer } from "./ghost_box";
import { GizmoControl } from "./gizmo_control";
import { centreOf, diagonalOf, unionOf } from "./interval";
import { placed } from "./part_box";
import { type Pose, poseAt } from "./pose";
import { Previews } from "./previews";
import { SourcePicker } from "./source_picker";
import { View } from "./view";

/// Milliseconds that the points of the first preview may take to be on the screen.
const kPatience = 15_000;

export interface PlacedPart {
  source: Source;
  pose: Pose;
  pivot: Vec3; // middle of the part, in its own coordinates
  extent: Box; // of the whole part, in its own coordinates
}

export abstract class PlacedTool implements Tool {
  abstract readonly id: string;
  abstract readonly title: string;
  abstract readonly key: string;
  abstract readonly icon: string;
  abstract readonly hint: string;
  abstract settings(): TemplateResult;

  protected readonly previews: Previews;
  protected readonly picker: SourcePicker;
  protected readonly gizmo: GizmoControl;
  protected part: PlacedPart | null = null;
  protected measuring = false;

  constructor(
    protected readonly context: ToolContext,
    name: string,
    kinds: FileKind[],
  ) {
    this.previews = new Previews(context.connection, () => context.redraw());
    this.picker = new SourcePicker(context, name, kinds, () => void this.begin());
    this.gizmo = new GizmoControl({
      viewport: context.viewport,
      options: () => ({ move: true, turn: true, scale: "uniform" }),
      moved: (pose) => this.moved(pose),
      released: () => this.preview(),
    }, name);
  }

  protected abstract operation(part: PlacedPart): Operation;
  /// Where the middle of a part of that size is put at first.
  protected abstract firstPlace(extent: Box): Pose;
  /// A new part was chosen: settings about the old one go.
  protected abstract renewed(): void;

  private async begin(): Promise<void> {
    const { source } = this.picker;
    if (!source || !this.context.store.scene || this.measuring) return;
    this.measuring = true;
    this.part = null;
    this.renewed();
    this.previews.end();
    const extent = await this.measure(source);
    this.measuring = false;
    // Another one may have been chosen while this one was measured.
    if (this.picker.source && this.picker.source !== source) return this.begin();
    if (extent && this.picker.source) this.place(source, extent);
    this.context.redraw();
  }

  private place(source: Source, extent: Box): void {
    this.part = { source, pose: this.firstPlace(extent), pivot: centreOf(extent), extent };
    this.preview();
    const { viewport } = this.context;
    const seen = this.corners(this.part).every((corner) => this.isSeen(corner));
    if (!seen) viewport.frame(unionOf([viewport.box, ...this.corners(this.part).map((p) => ({ lower: p, upper: p }))])!);
  }

  /// Of the box of the part, placed.
  private corners({ extent, pose, pivot }: PlacedPart): Vec3[] {
    const corner = (bits: number) => [0, 1, 2].map((a) => (bits & (1 << a) ? extent.upper[a]! : extent.lower[a]!)) as Vec3;
    return [0, 1, 2, 3, 4, 5, 6, 7].map((bits) => placed(corner(bits), pose, pivot));
  }

  private isSeen(p: Vec3): boolean {
    const camera = this.context.viewport.cameraDocument();
    const at = new View(camera).project(p);
    return at !== null && at.x > 0 && at.y > 0 && at.x < camera.width && at.y < camera.height;
  }

  /// Where a part is taken to be whose points cannot be shown beforehand; null: it cannot be used.
  protected unseen(_: Error): Box | null {
    return null;
  }

  /// Box of the part where it lies by itself, from the points of its preview; null where there is none.
  private async measure(source: Source): Promise<Box | null> {
    const { connection, store, viewport } = this.context;
    const operation: InsertOperation = { op: "insert", ...source };
    const before = store.ghosts;
    try {
      await connection.request("preview", { operation });
      this.previews.shown = true;
      await this.ghostsAfter(before);
      return boxOfLayer(viewport.ghosts.group);
    } catch (error) {
      return this.unseen(error as Error);
    }
  }

  /// Waits for other ghosts than those. @throws Error where none come
  private ghostsAfter(before: unknown): Promise<void> {
    const { store } = this.context;
    return new Promise((resolve, reject) => {
      const end = () => {
        store.removeEventListener("change", look);
        clearTimeout(timer);
      };
      const look = () => {
        if (store.ghosts === before || !store.ghosts) return;
        end();
        resolve();
      };
      const timer = setTimeout(() => {
        end();
        reject(new Error("The points of the part did not arrive"));
      }, kPatience);
      store.addEventListener("change", look);
      look();
    });
  }

  // ---- previews and commits ----

  protected preview(): void {
    if (this.part) this.previews.show(this.operation(this.part));
    this.context.redraw();
  }

  private moved(pose: Pose): void {
    if (!this.part || this.previews.committing) return;
    this.part = { ...this.part, pose };
    this.preview();
  }

  protected async commit(): Promise<void> {
    if (!this.part) return;
    const record = await this.previews.commit(this.operation(this.part));
    if (record) this.drop();
    else if (this.previews.error) this.context.notice("error", this.previews.error);
  }

  protected drop(): void {
    this.part = null;
    this.picker.source = null;
    this.renewed();
    this.previews.end();
    this.context.redraw();
  }

  deactivate(): void {
    this.drop();
  }

  /// Scale at which a part fits a scene that is many times larger or smaller; 1 where they are alike.
  protected fitting(extent: Box, share: number): number {
    const ratio = diagonalOf(this.context.viewport.box) / diagonalOf(extent);
    return ratio > 5 || ratio < 0.2 ? share * ratio : 1;
  }

  protected posed(position: Vec3, scale: number): Pose {
    return { ...poseAt(position), scale: [scale, scale, scale] };
  }

  // ---- pointer, keys, drawing ----

  pointerDown(e: ToolPointer): boolean {
    return this.part !== null && !this.previews.committing && this.gizmo.down(e, this.part.pose);
  }

  pointerMove(e: ToolPointer): void {
    if (this.part) this.gizmo.move(e, this.part.pose);
    this.context.redraw();
  }

  pointerUp(_: ToolPointer): void {
    this.gizmo.up();
    this.context.redraw();
  }

  keyDown(e: KeyboardEvent): boolean {
    if (!this.part) return false;
    if (e.key === "Enter") void this.commit();
    else if (e.key === "Escape") this.drop();
    else return this.gizmo.key(e, this.part.pose);
    return true;
  }

  overlay(): SVGTemplateResult {
    return svg`<g data-testid="tool-overlay">${this.part ? this.gizmo.overlay(this.part.pose) : nothing}</g>`;
  }
}
