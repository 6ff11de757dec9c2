// What all tools share that draw a stroke or an area in the picture: a shape is drawn, its effect is previewed, Enter
// applies it, Esc drops it. A shape belongs to the camera it was drawn with; when that has moved on, the preview stays
// and the lines go.
import { type SVGTemplateResult, type TemplateResult, nothing, svg } from "lit";
import type { CameraJson, Operation, Pixel } from "../../engine/protocol";
import type { Tool, ToolContext, ToolPointer } from "../tool";
import { drawCursor, drawHandle, drawPath } from "./draw";
import { type Gesture, type Shape, handlesOf, isNear, withHandle } from "./gestures";
import { Previews } from "./previews";
import { areaPath, linePath } from "./shapes";
import { pixelOf, sameCamera } from "./view";

export abstract class ShapeTool implements Tool {
  abstract readonly id: string;
  abstract readonly title: string;
  abstract readonly key: string;
  abstract readonly icon: string;
  abstract readonly hint: string;
  abstract settings(): TemplateResult;

  protected readonly previews: Previews;
  protected cursor: Pixel | null = null;
  private camera: CameraJson | null = null; // of the present shape
  private held = -1; // the handle in hand

  constructor(
    protected readonly context: ToolContext,
    protected gesture: Gesture,
  ) {
    this.previews = new Previews(context.connection, () => context.redraw());
  }

  /// What the shape does; null: nothing can be done with it.
  protected abstract operation(camera: CameraJson, shape: Shape): Operation | null;

  /// Whether a shape that begins now is added to those there are.
  protected adds(e: ToolPointer): boolean {
    return e.shift || e.alt;
  }

  /// Radius of the cursor's ring in pixels.
  protected cursorRadius(): number {
    return 0;
  }

  protected get pending(): boolean {
    return this.gesture.shape() !== null;
  }

  private get inSight(): boolean {
    return this.camera !== null && sameCamera(this.camera, this.context.viewport.cameraDocument());
  }

  deactivate(): void {
    this.drop();
    this.cursor = null;
  }

  pointerDown(e: ToolPointer): boolean {
    if (e.button !== 0 || !this.context.store.scene) return false;
    const p = pixelOf(e);
    const shape = this.gesture.shape();
    this.held = shape && this.inSight ? handlesOf(shape).findIndex((handle) => isNear(p, handle)) : -1;
    if (this.held >= 0) return true;
    // Loops of two cameras make no area.
    if (this.camera && !this.inSight) this.gesture.clear();
    this.camera = this.context.viewport.cameraDocument();
    this.gesture.down(p, this.adds(e));
    this.cursor = p;
    this.context.redraw();
    return true;
  }

  pointerMove(e: ToolPointer): void {
    const p = pixelOf(e);
    this.cursor = p;
    const shape = this.gesture.shape();
    if (this.held >= 0 && shape) {
      this.gesture.replace(withHandle(shape, this.held, p));
      this.preview();
    } else {
      this.gesture.move(p);
    }
    this.context.redraw();
  }

  pointerUp(e: ToolPointer): void {
    if (this.held >= 0) {
      this.held = -1;
    } else {
      this.gesture.up(pixelOf(e));
      this.finished();
    }
    this.context.redraw();
  }

  /// A shape is complete, or what was drawn came to nothing.
  private finished(): void {
    if (this.gesture.drawing) return;
    if (this.gesture.shape()) this.preview();
    else this.previews.end();
  }

  keyDown(e: KeyboardEvent): boolean {
    if (this.gesture.key?.(e.key)) {
      this.finished();
    } else if (e.key === "Enter" && this.pending) {
      void this.commit();
    } else if (e.key === "Escape" && (this.pending || this.gesture.drawing)) {
      this.drop();
    } else {
      return false;
    }
    this.context.redraw();
    return true;
  }

  /// Asks for the effect of the shape as the settings are now.
  protected preview(): void {
    const operation = this.present();
    if (operation) this.previews.show(operation);
  }

  private present(): Operation | null {
    const shape = this.gesture.shape();
    return shape && this.camera ? this.operation(this.camera, shape) : null;
  }

  /// The shape is gone at once, so that the next can be drawn while the engine works; it is back if that failed.
  protected async commit(): Promise<void> {
    const operation = this.present();
    if (!operation || this.previews.committing) return;
    if (this.previews.empty) return this.context.notice("info", "There is no point that this would change");
    const [shape, camera] = [this.gesture.shape()!, this.camera];
    this.forget();
    const record = await this.previews.commit(operation);
    if (record) return;
    if (this.previews.error) this.context.notice("error", this.previews.error);
    if (this.gesture.drawing || this.pending) return;
    this.gesture.replace(shape);
    this.camera = camera;
    this.context.redraw();
  }

  private forget(): void {
    this.gesture.clear();
    this.camera = null;
    this.held = -1;
    this.context.redraw();
  }

  protected drop(): void {
    this.forget();
    this.previews.end();
  }

  overlay(): SVGTemplateResult {
    const shape = this.gesture.shape();
    const seen = this.gesture.drawing || this.inSight;
    return svg`<g data-testid="tool-overlay">
      ${seen ? this.drawShape(shape) : nothing}
      ${this.cursor && this.held < 0 ? drawCursor(this.cursor, this.cursorRadius()) : nothing}
    </g>`;
  }

  private drawShape(shape: Shape | null): SVGTemplateResult {
    const moving = !this.context.viewport.still;
    const before = shape ? [] : (this.gesture.closed?.() ?? []);
    const corners = this.gesture.corners?.() ?? [];
    return svg`
      ${drawPath(areaPath(before), { fill: true, dashes: true })}
      ${drawPath(linePath(this.gesture.open()), { testid: "shape-open" })}
      ${corners.map((p, i) => drawHandle(p, i === 0 && corners.length > 2))}
      ${shape ? drawPath(pathOf(shape), styleOf(shape, moving)) : nothing}
      ${shape ? handlesOf(shape).map((p, i) => drawHandle(p, i === this.held, `shape-handle-${i}`)) : nothing}`;
  }
}

function pathOf(shape: Shape): string {
  if (shape.kind === "stroke") return linePath(shape.points);
  if (shape.kind === "area") return areaPath(shape.loops);
  const [x0, y0, x1, y1] = shape.corners;
  return areaPath([[[x0, y0], [x1, y0], [x1, y1], [x0, y1]]]);
}

function styleOf(shape: Shape, moving: boolean) {
  const area = shape.kind !== "stroke";
  return { fill: area, dashes: area, moving: area && moving, testid: "shape" };
}
