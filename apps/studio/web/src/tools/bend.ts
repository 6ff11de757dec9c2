// Bends the cloud by handles: balls set by clicks. One is dragged by the gizmo, those that are not hold their places.
import { type SVGTemplateResult, type TemplateResult, html, nothing, svg } from "lit";
import type { DeformOperation, Pixel } from "../engine/protocol";
import { button, segmentsRow, switchRow, sliderRow } from "../ui/controls";
import { DeformTool } from "./shared/deform_tool";
import { type Ball, bendOf } from "./shared/documents";
import { drawHandle, drawRing, kBlue, kOrange } from "./shared/draw";
import { actions, applyBar, countOf, note } from "./shared/fields";
import { GizmoControl } from "./shared/gizmo_control";
import { isNear } from "./shared/gestures";
import { diagonalOf } from "./shared/interval";
import { type Pose, isAtRest, poseAt } from "./shared/pose";
import { View, pixelOf } from "./shared/view";
import { register } from "./registry";
import type { ToolContext, ToolPointer } from "./tool";

const kMostHandles = 16; // as the engine has it

interface BendState {
  balls: Ball[];
  chosen: number;
}

class BendTool extends DeformTool<BendState> {
  readonly id = "bend";
  readonly title = "Bend by handles";
  readonly key = "d";
  readonly icon = "M4 18c6 0 5-11 14-11M4 18h.01M18 7h.01M7 18a3 3 0 11-6 0 3 3 0 016 0zM22 7a3 3 0 11-6 0 3 3 0 016 0z";
  readonly hint = "Click to set handles, drag one by its gizmo; [ ] radius, Delete removes";
  protected state: BendState = { balls: [], chosen: -1 };
  private affine = false;
  private radius = 0; // of the next handle; 0: a tenth of the scene
  private readonly gizmo: GizmoControl;

  constructor(context: ToolContext) {
    super(context);
    this.gizmo = new GizmoControl({
      viewport: context.viewport,
      options: () => ({ move: true, turn: true, scale: this.affine ? "axes" : "none" }),
      moved: (pose) => this.moved(pose),
      released: () => this.released(),
    }, "bend");
  }

  private get ball(): Ball | undefined {
    return this.state.balls[this.state.chosen];
  }

  private get size(): number {
    return diagonalOf(this.context.viewport.box);
  }

  protected operation(): DeformOperation | null {
    const moved = this.state.balls.some((ball) => !isAtRest(ball.pose, ball.centre));
    return moved ? bendOf(this.state.balls, this.affine) : null;
  }

  protected settled(): BendState {
    const balls = this.state.balls.map(({ radius, pose }) => {
      const grown = this.affine ? Math.cbrt(pose.scale[0] * pose.scale[1] * pose.scale[2]) : 1;
      return { centre: pose.position, radius: radius * grown, pose: poseAt(pose.position) };
    });
    return { ...this.state, balls };
  }

  protected reset(): void {
    const balls = this.state.balls.map((ball) => ({ ...ball, pose: poseAt(ball.centre) }));
    this.state = { ...this.state, balls };
  }

  protected forget(): void {
    this.state = { balls: [], chosen: -1 };
    this.radius = 0;
  }

  private change(patch: Partial<Ball>): void {
    const balls = this.state.balls.map((ball, i) => (i === this.state.chosen ? { ...ball, ...patch } : ball));
    this.state = { ...this.state, balls };
    this.preview();
  }

  private moved(pose: Pose): void {
    if (!this.previews.committing) this.change({ pose });
  }

  // ---- pointer and keys ----

  pointerDown(e: ToolPointer): boolean {
    if (e.button !== 0 || !this.context.store.scene || this.previews.committing) return false;
    if (this.ball && this.gizmo.down(e, this.ball.pose)) return true;
    const view = new View(this.context.viewport.cameraDocument());
    const at = this.state.balls.findIndex((ball) => {
      const centre = view.project(ball.pose.position);
      return centre && isNear(pixelOf(e), [centre.x, centre.y], 10);
    });
    if (at >= 0) this.choose(at);
    else if (!this.set(e)) return false;
    return true;
  }

  private choose(chosen: number): void {
    this.state = { ...this.state, chosen };
    this.context.redraw();
  }

  /// A handle where the pointer is on the surface.
  private set(e: ToolPointer): boolean {
    const pick = e.pick();
    if (!pick) return false;
    if (this.state.balls.length >= kMostHandles) {
      this.context.notice("warning", `There are ${kMostHandles} handles, and no more than that`);
      return true;
    }
    const radius = this.radius || 0.1 * this.size;
    const ball = { centre: pick.point, radius, pose: poseAt(pick.point) };
    this.state = { balls: [...this.state.balls, ball], chosen: this.state.balls.length };
    this.preview();
    return true;
  }

  pointerMove(e: ToolPointer): void {
    if (this.ball) this.gizmo.move(e, this.ball.pose);
    this.context.redraw();
  }

  pointerUp(): void {
    this.gizmo.up();
    this.context.redraw();
  }

  override keyDown(e: KeyboardEvent): boolean {
    const grow = { "[": -1, "]": 1 }[e.key];
    if (grow) this.setRadius((this.ball?.radius ?? (this.radius || 0.1 * this.size)) * 1.1 ** grow);
    else if ((e.key === "Delete" || e.key === "Backspace") && this.ball) this.remove();
    else if (!(this.ball && this.gizmo.key(e, this.ball.pose))) return super.keyDown(e);
    this.context.redraw();
    return true;
  }

  private setRadius(radius: number): void {
    this.radius = radius;
    if (this.ball) this.change({ radius });
    this.context.redraw();
  }

  private remove(): void {
    const balls = this.state.balls.filter((_, i) => i !== this.state.chosen);
    this.state = { balls, chosen: balls.length - 1 };
    if (this.operation()) this.preview();
    else this.previews.end();
    this.context.redraw();
  }

  // ---- what is shown ----

  overlay(): SVGTemplateResult {
    const view = new View(this.context.viewport.cameraDocument());
    return svg`<g data-testid="tool-overlay">
      ${this.state.balls.map((ball, i) => this.drawBall(view, ball, i))}
      ${this.ball ? this.gizmo.overlay(this.ball.pose) : nothing}
    </g>`;
  }

  private drawBall(view: View, ball: Ball, i: number): SVGTemplateResult {
    const centre = view.project(ball.pose.position);
    if (!centre) return svg``;
    const at: Pixel = [centre.x, centre.y];
    const chosen = i === this.state.chosen;
    const colour = chosen ? kOrange : kBlue;
    return svg`${drawRing(at, ball.radius / view.pixelSize(ball.pose.position), colour, !chosen)}
      ${chosen ? nothing : drawHandle(at, false, `bend-handle-${i}`, colour)}`;
  }

  settings(): TemplateResult {
    const { balls, chosen } = this.state;
    const size = this.size;
    return html`
      ${segmentsRow({
        label: "Handle",
        testid: "bend-kind",
        value: this.affine ? "affine" : "rigid",
        choices: [
          { value: "rigid", label: "Rigid", title: "A handle moves and turns" },
          { value: "affine", label: "Affine", title: "A handle stretches, too" },
        ],
        change: (kind) => this.setKind(kind === "affine"),
      })}
      ${sliderRow({
        label: "Radius",
        title: "Radius of the handle in world units ([ and ])",
        testid: "bend-radius",
        value: this.ball?.radius ?? (this.radius || 0.1 * size),
        min: 0,
        max: size / 2,
        step: size / 500,
        input: (radius) => this.setRadius(radius),
        change: (radius) => this.setRadius(radius),
      })}
      ${this.ball ? this.gizmo.fields(this.ball.pose, size / 200) : nothing}
      ${this.eachDragRow()}
      ${note(this.advice(), "tool-state", this.previews.error !== "")}
      ${actions(
        button({ label: "Remove handle", testid: "bend-remove", title: "Remove the chosen handle (Delete)", disabled: !this.ball, run: () => this.remove() }),
        button({ label: "Next", testid: "bend-next", title: "Choose the next handle", disabled: balls.length < 2, run: () => this.choose((chosen + 1) % balls.length) }),
      )}
      ${applyBar({ ready: this.pending, busy: this.previews.committing, apply: () => void this.commit(), drop: () => this.drop() })}`;
  }

  private setKind(affine: boolean): void {
    this.affine = affine;
    this.preview();
  }

  private eachDragRow(): TemplateResult {
    return switchRow({
      label: "Auto-apply",
      title: "A drag is a step of the history when it ends; else Enter applies",
      testid: "bend-each-drag",
      value: this.eachDrag,
      change: (value) => {
        this.eachDrag = value;
        this.context.redraw();
      },
    });
  }

  private advice(): string {
    if (this.previews.error) return this.previews.error;
    const { balls } = this.state;
    if (balls.length === 0) return "Click where the cloud is to be held, then where it is to be moved";
    if (balls.length === 1) return "One handle alone moves everything: set another where the cloud is to stay";
    return `${countOf(balls.length, "handle")}: the orange one is dragged, the blue ones hold`;
  }
}

export const bend = register((context) => new BendTool(context));
