// A gizmo in the hand of a tool: pointer, keys, what is drawn, and the same numbers as fields.
import { type SVGTemplateResult, type TemplateResult, html, nothing, svg } from "lit";
import type { Pixel, Vec3 } from "../../engine/protocol";
import type { Viewport } from "../../view/viewport";
import { numberRow } from "../../ui/controls";
import type { ToolPointer } from "../tool";
import { drawLabel, drawPath, kBlue, kLight, kOrange } from "./draw";
import { vectorRow } from "./fields";
import { GizmoDrag, type GizmoOptions, type Grip, gripAt, gripsOf, kGrip, poseByKey } from "./gizmo";
import type { Pose } from "./pose";
import { areaPath, linePath } from "./shapes";
import { degreesOf, turnOfDegrees } from "./vec";
import { View, pixelOf } from "./view";

const kColours = [kOrange, kBlue, "#d9dce2"];
const kFinger = 20; // pixels: a finger is no needle

export interface GizmoHost {
  viewport: Pick<Viewport, "cameraDocument">;
  options(): GizmoOptions;
  /// The pose while it changes.
  moved(pose: Pose): void;
  /// The pointer was let go after the pose had changed.
  released(): void;
}

export class GizmoControl {
  private drag: GizmoDrag | null = null;
  private changed = false;
  private hovered = "";

  constructor(
    private readonly host: GizmoHost,
    private readonly name: string, // begins the test ids of the fields
  ) {}

  get dragging(): boolean {
    return this.drag !== null;
  }

  private view(): View {
    return new View(this.host.viewport.cameraDocument());
  }

  private grip(e: ToolPointer, pose: Pose): Grip | null {
    const within = e.pointerType === "touch" ? kFinger : kGrip;
    return gripAt(gripsOf(this.view(), pose, this.host.options()), pixelOf(e), within);
  }

  /// @returns true if a part of the gizmo was gripped
  down(e: ToolPointer, pose: Pose): boolean {
    const grip = e.button === 0 ? this.grip(e, pose) : null;
    if (!grip) return false;
    this.drag = new GizmoDrag(grip.part, pose, this.view(), pixelOf(e));
    this.hovered = grip.id;
    this.changed = false;
    return true;
  }

  /// @returns true while a part is dragged
  move(e: ToolPointer, pose: Pose): boolean {
    if (!this.drag) {
      this.hovered = this.grip(e, pose)?.id ?? "";
      return false;
    }
    this.changed = true;
    this.host.moved(this.drag.to(pixelOf(e), e.ctrl));
    return true;
  }

  up(): boolean {
    if (!this.drag) return false;
    this.drag = null;
    if (this.changed) this.host.released();
    return true;
  }

  key(e: KeyboardEvent, pose: Pose): boolean {
    const next = poseByKey(e, pose, this.view(), this.host.options());
    if (next) this.host.moved(next);
    return next !== null;
  }

  // ---- what is drawn ----

  overlay(pose: Pose): SVGTemplateResult {
    const grips = gripsOf(this.view(), pose, this.host.options());
    return svg`<g data-testid="gizmo">${[...grips].reverse().map((grip) => this.drawGrip(grip))}</g>`;
  }

  private drawGrip(grip: Grip): SVGTemplateResult {
    const { part, points } = grip;
    const hot = grip.id === this.hovered;
    const colour = hot ? "#ffd34d" : "axis" in part ? kColours[part.axis]! : kLight;
    const [end] = points.slice(-1);
    if (!end || grip.faint) return svg``;
    const [x, y] = end;
    const parts = {
      free: () => svg`<circle cx=${x} cy=${y} r="7" fill=${colour} fill-opacity="0.35" stroke=${colour} stroke-width="1.75" />`,
      size: () => drawPath(`M${x - 6} ${y - 2}V${y - 6}H${x - 2}M${x + 2} ${y + 6}H${x + 6}V${y + 2}M${x - 5} ${y - 5}L${x + 5} ${y + 5}`, { colour }),
      scale: () => svg`<rect x=${x - 5} y=${y - 5} width="10" height="10" rx="1.5" fill=${colour} stroke="#15171b" />`,
      plane: () => drawPath(areaPath([points.slice(0, 4)]), { colour, fill: true, width: hot ? 2.25 : 1.25 }),
      turn: () => drawPath(linePath(points), { colour, width: hot ? 3 : 1.5, faint: !hot }),
      move: () => this.drawArrow(points[0]!, end, colour, hot, "axis" in part ? part.axis : 0),
    };
    return svg`<g data-testid="gizmo-${grip.id}" data-x=${x.toFixed(1)} data-y=${y.toFixed(1)}>${parts[part.kind]()}</g>`;
  }

  private drawArrow(from: Pixel, to: Pixel, colour: string, hot: boolean, axis: number): SVGTemplateResult {
    const l = Math.hypot(to[0] - from[0], to[1] - from[1]) || 1;
    const [dx, dy] = [(to[0] - from[0]) / l, (to[1] - from[1]) / l];
    const back = (side: number): Pixel => [to[0] - 11 * dx - 4.5 * side * dy, to[1] - 11 * dy + 4.5 * side * dx];
    const label: Pixel = [to[0] + 10 * dx - 3, to[1] + 10 * dy + 4];
    return svg`${drawPath(linePath([from, to]), { colour, width: hot ? 3 : 2 })}
      <path d=${areaPath([[to, back(1), back(-1)]])} fill=${colour} stroke="#15171b" stroke-width="0.75" />
      ${this.host.options().own ? nothing : drawLabel(label, "XYZ"[axis]!)}`;
  }

  // ---- fields ----

  /// @param step  world units that a step of a position field is
  fields(pose: Pose, step: number): TemplateResult {
    const { move, turn, scale } = this.host.options();
    return html`
      ${move ? this.row(pose, "Position", pose.position, step, (position) => ({ position })) : nothing}
      ${turn ? this.row(pose, "Turn °", degreesOf(pose.rotation), 1, (degrees) => ({ rotation: turnOfDegrees(degrees) })) : nothing}
      ${scale === "axes" ? this.row(pose, "Scale", pose.scale, 0, (s) => ({ scale: s })) : nothing}
      ${scale === "uniform" ? this.scaleRow(pose) : nothing}`;
  }

  private set(pose: Pose, patch: Partial<Pose>): void {
    const { spin: _, ...rest } = pose;
    this.host.moved("rotation" in patch ? { ...rest, ...patch } : { ...pose, ...patch });
  }

  private settle(pose: Pose, patch: Partial<Pose>): void {
    this.set(pose, patch);
    this.host.released();
  }

  private row(pose: Pose, label: string, value: Vec3, step: number, patch: (value: Vec3) => Partial<Pose>): TemplateResult {
    return vectorRow({
      label,
      testid: `${this.name}-${label.split(" ")[0]!.toLowerCase()}`,
      value,
      step,
      input: (v) => this.set(pose, patch(v)),
      change: (v) => this.settle(pose, patch(v)),
    });
  }

  private scaleRow(pose: Pose): TemplateResult {
    const all = (s: number) => ({ scale: [s, s, s] as Vec3 });
    return numberRow({
      label: "Scale",
      testid: `${this.name}-scale`,
      value: pose.scale[0],
      min: 1e-9,
      input: (s) => this.set(pose, all(s)),
      change: (s) => this.settle(pose, all(s)),
    });
  }
}
