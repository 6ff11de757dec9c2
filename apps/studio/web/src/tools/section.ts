// A plane that cuts the view open: moved along its normal and turned by a gizmo. It changes what is seen, nothing else.
import { type SVGTemplateResult, type TemplateResult, html, nothing, svg } from "lit";
import type { Vec3 } from "../engine/protocol";
import { button, sliderRow, switchRow } from "../ui/controls";
import { actions, vectorRow } from "./shared/fields";
import { GizmoControl } from "./shared/gizmo_control";
import { centreOf, diagonalOf } from "./shared/interval";
import { type Pose, poseAt } from "./shared/pose";
import { type Quat, along, axisVector, cross, dot, noTurn, normalise, sub, turn, turnAbout } from "./shared/vec";
import { View } from "./shared/view";
import { register } from "./registry";
import type { Tool, ToolContext, ToolPointer } from "./tool";

/// The shortest turn that brings the z axis to `normal`.
export function turnTo(normal: Vec3): Quat {
  const z: Vec3 = [0, 0, 1];
  const cosine = dot(z, normal);
  if (cosine > 1 - 1e-12) return noTurn;
  if (cosine < -1 + 1e-12) return turnAbout([1, 0, 0], Math.PI);
  return turnAbout(cross(z, normal), Math.acos(cosine));
}

class SectionTool implements Tool {
  readonly id = "section";
  readonly title = "Section plane";
  readonly key = "x";
  readonly icon = "M4 8l8-4 8 4-8 4zM4 8v8l8 4 8-4V8M2 13l20-4";
  readonly hint = "Drag the arrow to move the cut, the rings to turn it; [ ] steps, Esc closes";
  private pose: Pose | null = null;
  private on = false;
  private readonly gizmo: GizmoControl;

  constructor(private readonly context: ToolContext) {
    this.gizmo = new GizmoControl({
      viewport: context.viewport,
      options: () => ({ move: true, moveAxes: [2], turn: true, turnAxes: [0, 1], scale: "none", own: true }),
      moved: (pose) => this.set(pose),
      released: () => undefined,
    }, "section");
  }

  private get normal(): Vec3 {
    return this.pose ? turn(this.pose.rotation, [0, 0, 1]) : [0, 0, 1];
  }

  activate(): void {
    if (!this.on) this.faceAxis(new View(this.context.viewport.cameraDocument()).back);
  }

  /// The plane through the middle, at right angles to the axis that is nearest to a direction, and cutting away the side
  /// that it points to.
  private faceAxis(direction: Vec3): void {
    const sizes = direction.map(Math.abs);
    const axis = sizes.indexOf(Math.max(...sizes));
    const normal = axisVector(axis).map((v) => v * (direction[axis]! < 0 ? -1 : 1)) as Vec3;
    this.set({ ...poseAt(centreOf(this.context.viewport.box)), rotation: turnTo(normal) });
  }

  private set(pose: Pose): void {
    this.pose = pose;
    this.on = true;
    this.show();
  }

  private show(): void {
    const { store, viewport } = this.context;
    viewport.setSection(this.on && this.pose ? { point: this.pose.position, normal: this.normal } : null);
    if (store.view.section !== this.on) store.setView({ section: this.on });
    this.context.redraw();
  }

  private close(): void {
    this.on = false;
    this.show();
  }

  // ---- pointer and keys ----

  pointerDown(e: ToolPointer): boolean {
    return this.on && this.pose !== null && this.gizmo.down(e, this.pose);
  }

  pointerMove(e: ToolPointer): void {
    if (this.on && this.pose) this.gizmo.move(e, this.pose);
    this.context.redraw();
  }

  pointerUp(): void {
    this.gizmo.up();
    this.context.redraw();
  }

  keyDown(e: KeyboardEvent): boolean {
    if (!this.on || !this.pose) return false;
    const step = (e.shiftKey ? 10 : 1) * (diagonalOf(this.context.viewport.box) / 500);
    const way = { "[": -1, "]": 1, PageDown: -1, PageUp: 1 }[e.key];
    if (way) this.set({ ...this.pose, position: along(this.pose.position, this.normal, way * step) });
    else if (e.key === "Escape") this.close();
    else return false;
    return true;
  }

  // ---- what is shown ----

  overlay(): SVGTemplateResult {
    return svg`<g data-testid="tool-overlay">${this.on && this.pose ? this.gizmo.overlay(this.pose) : nothing}</g>`;
  }

  settings(): TemplateResult {
    const box = this.context.viewport.box;
    const half = diagonalOf(box) / 2;
    const position = this.pose ? dot(sub(this.pose.position, centreOf(box)), this.normal) : 0;
    const moveTo = (at: number) =>
      this.pose && this.set({ ...this.pose, position: along(this.pose.position, this.normal, at - position) });
    const facing = (direction: Vec3) => () => this.faceAxis(direction);
    return html`
      ${switchRow({
        label: "Cut the view",
        title: "Hide what the plane's arrow points into (Esc closes)",
        testid: "section-on",
        value: this.on,
        change: (value) => (value && this.pose ? this.set(this.pose) : this.close()),
      })}
      ${sliderRow({
        label: "Position",
        title: "Along the normal from the middle, world units ([ and ])",
        testid: "section-position",
        value: position,
        min: -half,
        max: half,
        step: half / 500,
        input: moveTo,
        change: moveTo,
      })}
      ${vectorRow({
        label: "Normal",
        testid: "section-normal",
        value: this.normal,
        change: (normal) => this.pose && Math.hypot(...normal) > 0 && this.set({ ...this.pose, rotation: turnTo(normalise(normal)) }),
      })}
      ${actions(
        button({ label: "X", testid: "section-x", title: "At right angles to the x axis", run: facing([1, 0, 0]) }),
        button({ label: "Y", testid: "section-y", title: "At right angles to the y axis", run: facing([0, 1, 0]) }),
        button({ label: "Z", testid: "section-z", title: "At right angles to the z axis", run: facing([0, 0, 1]) }),
        button({ label: "Turn round", testid: "section-flip", title: "Show the other side", run: () => this.turnRound() }),
        button({
          label: "Facing the view",
          testid: "section-view",
          title: "At right angles to the line of sight",
          run: () => this.set({ ...poseAt(centreOf(box)), rotation: turnTo(new View(this.context.viewport.cameraDocument()).back) }),
        }),
      )}`;
  }

  private turnRound(): void {
    if (!this.pose) return;
    const normal = this.normal.map((v) => -v) as Vec3;
    this.set({ ...this.pose, rotation: turnTo(normal) });
  }
}

export const section = register((context) => new SectionTool(context));
