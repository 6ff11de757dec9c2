// Guiding the surface, whatever the shape: settings that all guide tools have in common.
// Source: Zhou et al. 2010, section 5.1.
import { type TemplateResult, html, nothing } from "lit";
import type { CameraJson, Operation } from "../../engine/protocol";
import type { ToolContext } from "../tool";
import { type GuideSettings, guideOf } from "./documents";
import { numberRow, segmentsRow, switchRow } from "../../ui/controls";
import { applyBar, countOf, note } from "./fields";
import type { Gesture, Shape } from "./gestures";
import { cellWidth, centreOf, describeInterval, sceneBox, stepInterval } from "./interval";
import { ShapeTool } from "./shape_tool";
import { View } from "./view";

/// Normals that stand across the stroke part a surface; those of the cloud repair one.
const kStart: GuideSettings = { interval: 0, normals: "stroke", insideOnly: true };

export interface GuideLook {
  id: string;
  title: string;
  key: string;
  icon: string;
  hint: string;
}

export class GuideTool extends ShapeTool {
  readonly id: string;
  readonly title: string;
  readonly key: string;
  readonly icon: string;
  readonly hint: string;

  constructor(context: ToolContext, gesture: Gesture, look: GuideLook) {
    super(context, gesture);
    ({ id: this.id, title: this.title, key: this.key, icon: this.icon, hint: this.hint } = look);
  }

  /// The same for all guide tools: who changes the shape means the same interval.
  private get guide(): GuideSettings {
    return (this.context.store.selection["guide"] as GuideSettings | undefined) ?? kStart;
  }

  private change(patch: Partial<GuideSettings>): void {
    const selection = { ...this.context.store.selection, guide: { ...this.guide, ...patch } };
    this.context.store.update({ selection });
    this.preview();
    this.context.redraw();
  }

  protected operation(camera: CameraJson, shape: Shape): Operation {
    return guideOf(camera, shape, this.guide);
  }

  /// Half an interval where the scene's middle is, so that one sees how dense the points will be.
  protected override cursorRadius(): number {
    const box = sceneBox(this.context.store.scene);
    const cell = cellWidth(this.context.store.scene);
    if (!box || !cell) return 0;
    const view = new View(this.context.viewport.cameraDocument());
    return (this.guide.interval || cell) / 2 / view.pixelSize(centreOf(box));
  }

  override keyDown(e: KeyboardEvent): boolean {
    const cell = cellWidth(this.context.store.scene);
    const steps = { "[": -1, "]": 1 }[e.key];
    if (steps && cell) {
      this.change({ interval: stepInterval(this.guide.interval, cell, steps) });
      return true;
    }
    return super.keyDown(e);
  }

  settings(): TemplateResult {
    const { interval, normals, insideOnly } = this.guide;
    const cell = cellWidth(this.context.store.scene);
    return html`
      ${numberRow({
        label: "Interval",
        title: "Distance between guide points in world units, 0 for one cell ([ and ])",
        testid: "guide-interval",
        value: interval,
        min: 0,
        step: cell ? cell / 4 : 0.01,
        change: (value) => this.change({ interval: value }),
      })}
      ${note(describeInterval(interval, cell), "guide-interval-text")}
      ${this.id === "stroke" ? this.normalsRow(normals) : nothing}
      ${switchRow({
        label: "Inside only",
        title: "Only points inside of the present surface are added",
        testid: "guide-inside-only",
        value: insideOnly,
        change: (value) => this.change({ insideOnly: value }),
      })}
      ${this.state()}
      ${applyBar({ ready: this.pending, busy: this.previews.committing, apply: () => void this.commit(), drop: () => this.drop() })}`;
  }

  private normalsRow(value: GuideSettings["normals"]): TemplateResult {
    return segmentsRow({
      label: "Normals",
      testid: "guide-normals",
      value,
      choices: [
        { value: "cloud", label: "Cloud", title: "Between those of the points around" },
        { value: "stroke", label: "Stroke", title: "To the right of the stroke" },
      ],
      change: (normals) => this.change({ normals }),
    });
  }

  private state(): TemplateResult | typeof nothing {
    if (!this.pending) return nothing;
    if (this.previews.error) return note(this.previews.error, "tool-state", true);
    const { added } = this.previews;
    return note(added > 0 ? `${countOf(added, "point")} would be added` : "No point would be added", "tool-state");
  }
}
