// Copies a part of another cloud into the scene: chosen by a box or a lasso, placed by a gizmo, snapped onto the points.
import { type SVGTemplateResult, type TemplateResult, html, nothing, svg } from "lit";
import type { Box, Operation } from "../engine/protocol";
import { button, segmentsRow, switchRow } from "../ui/controls";
import { type Part, areaOf, insertOf } from "./shared/documents";
import { drawPath } from "./shared/draw";
import { actions, applyBar, countOf, note, vectorRow } from "./shared/fields";
import { LassoGesture } from "./shared/gestures";
import { centreOf, diagonalOf } from "./shared/interval";
import { type FaceDrag, dragFace, drawBox, faceAt } from "./shared/part_box";
import { type PlacedPart, PlacedTool } from "./shared/placed_tool";
import type { Pose } from "./shared/pose";
import { areaPath, linePath } from "./shared/shapes";
import { along } from "./shared/vec";
import { View, pixelOf, sameCamera } from "./shared/view";
import { register } from "./registry";
import type { ToolContext, ToolPointer } from "./tool";

type Mode = "place" | "box" | "lasso";

class CopyPartTool extends PlacedTool {
  readonly id = "copyPart";
  readonly title = "Copy a part";
  readonly key = "c";
  readonly icon = "M9 9h11v11H9zM15 9V4H4v11h5M14.5 12v5M12 14.5h5";
  readonly hint = "Choose a cloud, place a part of it by the gizmo; Enter adds, Esc drops";
  private mode: Mode = "place";
  private box: Box | null = null;
  private lasso: Part["lasso"] = null;
  private snap = false;
  private face: FaceDrag | null = null;
  private readonly loop = new LassoGesture();

  constructor(context: ToolContext) {
    super(context, "part", ["cloud", "mesh"]);
  }

  /// Beside the scene, on the right as it is seen now.
  protected firstPlace(extent: Box): Pose {
    const { viewport } = this.context;
    const { right } = new View(viewport.cameraDocument());
    const scale = this.fitting(extent, 0.5);
    const reach = (box: Box) => box.upper.reduce((sum, u, a) => sum + (Math.abs(right[a]!) * (u - box.lower[a]!)) / 2, 0);
    const apart = reach(viewport.box) + scale * reach(extent) + 0.05 * diagonalOf(viewport.box);
    return this.posed(along(centreOf(viewport.box), right, apart), scale);
  }

  protected override unseen(error: Error): null {
    this.context.notice("error", error.message);
    return null;
  }

  protected renewed(): void {
    this.mode = "place";
    this.box = this.lasso = this.face = null;
    this.loop.clear();
  }

  protected operation(part: PlacedPart): Operation {
    return insertOf({ ...part, box: this.box, lasso: this.lasso, snap: this.snap });
  }

  private setMode(mode: Mode): void {
    this.mode = mode;
    this.loop.clear();
    if (mode === "box" && this.part) this.box ??= this.part.extent;
    this.preview();
  }

  // ---- pointer ----

  override pointerDown(e: ToolPointer): boolean {
    if (!this.part || e.button !== 0 || this.previews.committing) return false;
    if (this.mode === "place") return super.pointerDown(e);
    if (this.mode === "box") return this.gripFace(e, this.part);
    this.loop.down(pixelOf(e), e.alt || e.shift);
    return true;
  }

  private gripFace(e: ToolPointer, part: PlacedPart): boolean {
    const view = new View(this.context.viewport.cameraDocument());
    const face = this.box && faceAt(view, this.box, part.pose, part.pivot, pixelOf(e));
    if (!face || !this.box) return false;
    this.face = { face, box: this.box, from: pixelOf(e), view };
    return true;
  }

  override pointerMove(e: ToolPointer): void {
    if (this.face && this.part) {
      this.box = dragFace(this.face, this.part.pose, this.part.pivot, pixelOf(e));
      return this.preview();
    }
    this.loop.move(pixelOf(e));
    super.pointerMove(e);
  }

  override pointerUp(e: ToolPointer): void {
    this.face = null;
    if (this.loop.drawing && this.part) {
      this.loop.up(pixelOf(e));
      const shape = this.loop.shape();
      const camera = this.context.viewport.cameraDocument();
      this.lasso = shape && { camera, area: areaOf(shape), pose: this.part.pose };
      this.preview();
    }
    super.pointerUp(e);
  }

  private whole(): void {
    this.box = this.lasso = null;
    this.loop.clear();
    this.mode = "place";
    this.preview();
  }

  // ---- what is shown ----

  override overlay(): SVGTemplateResult {
    const { part } = this;
    if (!part) return svg``;
    const camera = this.context.viewport.cameraDocument();
    const seen = this.lasso && this.mode === "lasso" && sameCamera(this.lasso.camera, camera);
    return svg`<g data-testid="tool-overlay">
      ${drawBox(new View(camera), this.box ?? part.extent, part.pose, part.pivot, this.mode === "box")}
      ${drawPath(linePath(this.loop.open()))}
      ${seen ? drawPath(areaPath(this.lasso!.area), { fill: true, dashes: true, testid: "shape" }) : nothing}
      ${this.mode === "place" ? this.gizmo.overlay(part.pose) : nothing}
    </g>`;
  }

  settings(): TemplateResult {
    return html`
      ${this.picker.template()}
      ${this.part ? this.placing(this.part) : note(this.measuring ? "Reading…" : "Choose the cloud that the part is of", "tool-state")}
      ${applyBar({ ready: !!this.part, busy: this.previews.committing, label: "Add", apply: () => void this.commit(), drop: () => this.drop() })}`;
  }

  private placing(part: PlacedPart): TemplateResult {
    const { added } = this.previews;
    const state = this.previews.error || `${countOf(added, "point")} of ${this.picker.title} would be added`;
    return html`
      ${segmentsRow<Mode>({
        label: "Pointer",
        testid: "part-mode",
        value: this.mode,
        choices: [
          { value: "place", label: "Place", title: "The gizmo moves, turns and scales the part" },
          { value: "box", label: "Box", title: "Faces of the box around what is copied are dragged" },
          { value: "lasso", label: "Lasso", title: "A loop around what is copied; hold Alt or Shift for further ones" },
        ],
        change: (mode) => this.setMode(mode),
      })}
      ${this.mode === "place" ? this.gizmo.fields(part.pose, diagonalOf(this.context.viewport.box) / 200) : nothing}
      ${this.mode === "box" ? this.boxRows(this.box ?? part.extent) : nothing}
      ${switchRow({
        label: "Snap",
        title: "Then moved rigidly onto the points near it",
        testid: "part-snap",
        value: this.snap,
        change: (value) => {
          this.snap = value;
          this.preview();
        },
      })}
      ${note(state, "tool-state", this.previews.error !== "")}
      ${this.box || this.lasso
        ? actions(button({ label: "Whole part", testid: "part-whole", title: "Without box and lasso", run: () => this.whole() }))
        : nothing}`;
  }

  private boxRows(box: Box): TemplateResult {
    const set = (patch: Partial<Box>) => {
      const next = { ...box, ...patch };
      if (next.lower.some((l, a) => l > next.upper[a]!)) return this.context.redraw();
      this.box = next;
      this.preview();
    };
    return html`
      ${vectorRow({ label: "From", testid: "part-box-lower", value: box.lower, change: (lower) => set({ lower }) })}
      ${vectorRow({ label: "To", testid: "part-box-upper", value: box.upper, change: (upper) => set({ upper }) })}`;
  }
}

export const copyPart = register((context) => new CopyPartTool(context));
