// Which way normals point: estimated, repaired, all turned round, turned round in an area, or towards where a scanner
// stood.
import { type SVGTemplateResult, type TemplateResult, html, nothing, svg } from "lit";
import type { CameraJson, Operation, OrientOperation, Vec3 } from "../engine/protocol";
import { button, segmentsRow } from "../ui/controls";
import { AreaTool } from "./shared/area_tool";
import { flipOf, orientOf } from "./shared/documents";
import { drawHandle, drawLabel, drawLine, kBlue, kOrange } from "./shared/draw";
import { actions, applyBar, countOf, note, vectorRow } from "./shared/fields";
import { GizmoControl } from "./shared/gizmo_control";
import { type Shape, isNear } from "./shared/gestures";
import { centreOf, diagonalOf } from "./shared/interval";
import { poseAt } from "./shared/pose";
import { View, meetPlane, pixelOf } from "./shared/view";
import { register } from "./registry";
import type { ToolContext, ToolPointer } from "./tool";

type Mode = "flip" | "sensor";

class OrientTool extends AreaTool {
  readonly id = "orient";
  readonly title = "Orient normals";
  readonly key = "o";
  readonly icon = "M3 17c4-5 14-5 18 0M7 13.5L5.5 8M12 13V6M17 13.5L18.5 8M10.5 7.5L12 5l1.5 2.5";
  readonly hint = "Draw around normals to turn them, or click where the scanner stood; Enter applies";
  private mode: Mode = "flip";
  private sensors: Vec3[] = [];
  private chosen = -1;
  private readonly gizmo: GizmoControl;

  constructor(context: ToolContext) {
    super(context);
    this.gizmo = new GizmoControl({
      viewport: context.viewport,
      options: () => ({ move: true, turn: false, scale: "none" }),
      moved: (pose) => this.setSensor(pose.position),
      released: () => undefined,
    }, "sensor");
  }

  protected operation(camera: CameraJson, shape: Shape): Operation {
    return flipOf(camera, shape, this.layers);
  }

  private setMode(mode: Mode): void {
    this.drop();
    this.mode = mode;
    this.context.redraw();
  }

  private get sensor(): Vec3 | undefined {
    return this.sensors[this.chosen];
  }

  private setSensor(position: Vec3): void {
    this.sensors = this.sensors.map((sensor, i) => (i === this.chosen ? position : sensor));
    this.context.redraw();
  }

  private addSensor(position: Vec3): void {
    this.sensors = [...this.sensors, position];
    this.chosen = this.sensors.length - 1;
    this.context.redraw();
  }

  private removeSensor(): void {
    this.sensors = this.sensors.filter((_, i) => i !== this.chosen);
    this.chosen = this.sensors.length - 1;
    this.context.redraw();
  }

  /// A job about all points at once, without a preview.
  private async all(method: OrientOperation["method"]): Promise<void> {
    const record = await this.previews.commit(orientOf(method, this.sensors));
    if (!record && this.previews.error) this.context.notice("error", this.previews.error);
    for (const text of record?.notes ?? []) this.context.notice("info", text);
    this.context.redraw();
  }

  // ---- pointer and keys ----

  override pointerDown(e: ToolPointer): boolean {
    if (this.mode === "flip") return super.pointerDown(e);
    if (e.button !== 0 || !this.context.store.scene) return false;
    if (this.sensor && this.gizmo.down(e, poseAt(this.sensor))) return true;
    const view = new View(this.context.viewport.cameraDocument());
    const at = this.sensors.findIndex((sensor) => {
      const p = view.project(sensor);
      return p !== null && isNear([p.x, p.y], pixelOf(e), 10);
    });
    if (at >= 0) this.chosen = at;
    else this.addSensor(this.placeOf(e, view));
    this.context.redraw();
    return true;
  }

  /// On what is under the pointer, else in the plane of the picture through the middle of the scene.
  private placeOf(e: ToolPointer, view: View): Vec3 {
    const pick = e.pick();
    if (pick) return pick.point;
    const centre = centreOf(this.context.viewport.box);
    return meetPlane(centre, view.back, view.ray(e.x, e.y)) ?? centre;
  }

  override pointerMove(e: ToolPointer): void {
    if (this.mode === "sensor" && this.sensor) this.gizmo.move(e, poseAt(this.sensor));
    super.pointerMove(e);
  }

  override pointerUp(e: ToolPointer): void {
    if (this.mode === "flip") return super.pointerUp(e);
    this.gizmo.up();
    this.context.redraw();
  }

  override keyDown(e: KeyboardEvent): boolean {
    if (this.mode === "flip") return super.keyDown(e);
    if (!this.sensor) return false;
    if (e.key === "Enter") void this.all("estimate");
    else if (e.key === "Delete" || e.key === "Backspace") this.removeSensor();
    else return this.gizmo.key(e, poseAt(this.sensor));
    return true;
  }

  // ---- what is shown ----

  override overlay(): SVGTemplateResult {
    if (this.mode === "flip") return super.overlay();
    const view = new View(this.context.viewport.cameraDocument());
    const middle = view.project(centreOf(this.context.viewport.box));
    return svg`<g data-testid="tool-overlay">
      ${this.sensors.map((sensor, i) => {
        const p = view.project(sensor);
        if (!p) return nothing;
        return svg`${middle ? drawLine([[p.x, p.y], [middle.x, middle.y]], { dashes: true, faint: true, colour: kBlue }) : nothing}
          ${drawHandle([p.x, p.y], i === this.chosen, `sensor-${i}`, i === this.chosen ? kOrange : kBlue)}
          ${drawLabel([p.x + 9, p.y - 9], `Sensor ${i + 1}`)}`;
      })}
      ${this.sensor ? this.gizmo.overlay(poseAt(this.sensor)) : nothing}
    </g>`;
  }

  settings(): TemplateResult {
    const busy = this.previews.committing || !this.context.store.scene;
    const all = (method: OrientOperation["method"], label: string, title: string) =>
      button({ label, testid: `orient-${method}`, title, disabled: busy, run: () => void this.all(method) });
    return html`
      ${actions(
        all("estimate", "Estimate", this.sensors.length > 0 ? "Estimate all normals, towards the sensors" : "Estimate all normals from the points around each"),
        all("repair", "Repair", "Keep normals that fit the points around, replace and turn the others"),
        all("turn", "Turn all", "Turn all normals round: inside becomes outside"),
      )}
      ${segmentsRow<Mode>({
        label: "Pointer",
        testid: "orient-mode",
        value: this.mode,
        choices: [
          { value: "flip", label: "Area", title: "Normals in the area drawn are turned round" },
          { value: "sensor", label: "Sensor", title: "A click says where a scanner stood" },
        ],
        change: (mode) => this.setMode(mode),
      })}
      ${this.mode === "flip" ? this.flipRows() : this.sensorRows()}`;
  }

  private flipRows(): TemplateResult {
    const turned = this.previews.added;
    const state = this.previews.error || (turned > 0 ? `${countOf(turned, "normal")} would be turned` : "No normal would be turned");
    return html`
      ${this.shapeRow()}
      ${this.layersRow()}
      ${this.pending ? note(state, "tool-state", this.previews.error !== "") : nothing}
      ${applyBar({ ready: this.pending, busy: this.previews.committing, apply: () => void this.commit(), drop: () => this.drop() })}`;
  }

  private sensorRows(): TemplateResult {
    const eye = () => this.addSensor(new View(this.context.viewport.cameraDocument()).eye);
    return html`
      ${this.sensor
        ? vectorRow({
            label: `Sensor ${this.chosen + 1}`,
            testid: "sensor-position",
            value: this.sensor,
            step: diagonalOf(this.context.viewport.box) / 200,
            input: (position) => this.setSensor(position),
            change: (position) => this.setSensor(position),
          })
        : nothing}
      ${note(this.sensors.length > 0 ? `Estimate turns normals towards ${countOf(this.sensors.length, "sensor")}` : "Click where the scanner stood", "tool-state")}
      ${actions(
        button({ label: "At the eye", testid: "sensor-eye", title: "A sensor where the view is seen from", run: eye }),
        button({ label: "Remove", testid: "sensor-remove", title: "Remove the chosen sensor (Delete)", disabled: !this.sensor, run: () => this.removeSensor() }),
      )}`;
  }
}

export const orientTool = register((context) => new OrientTool(context));
