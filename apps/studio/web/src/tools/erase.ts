// Takes points away: added ones, or with Shift or by the setting all; through the whole depth or in front only.
import { type TemplateResult, html, nothing } from "lit";
import type { CameraJson, Operation } from "../engine/protocol";
import { switchRow } from "../ui/controls";
import { AreaTool } from "./shared/area_tool";
import { removeOf } from "./shared/documents";
import { applyBar, countOf, note } from "./shared/fields";
import type { Shape } from "./shared/gestures";
import { register } from "./registry";
import type { ToolPointer } from "./tool";

class EraseTool extends AreaTool {
  readonly id = "erase";
  readonly title = "Erase points";
  readonly key = "e";
  readonly icon = "M9 19l-5-5 9-9 6 6-8 8zM8 10l6 6M9 19h10";
  readonly hint = "Draw around added points, with Shift around any; Enter removes, Esc drops";
  private originals = false;
  private shifted = false; // Shift was held when the shape was begun

  /// Shift means all points here, so that Alt alone adds loops.
  protected override adds(e: ToolPointer): boolean {
    return e.alt;
  }

  override pointerDown(e: ToolPointer): boolean {
    if (!this.pending || !e.alt) this.shifted = e.shift;
    return super.pointerDown(e);
  }

  private get all(): boolean {
    return this.originals || this.shifted;
  }

  protected operation(camera: CameraJson, shape: Shape): Operation {
    return removeOf(camera, shape, this.all, this.layers);
  }

  settings(): TemplateResult {
    return html`
      ${this.shapeRow()}
      ${this.layersRow()}
      ${switchRow({
        label: "All points",
        title: "Remove points of the scan too, as drawing with Shift held does",
        testid: "erase-originals",
        value: this.all,
        change: (value) => {
          this.originals = value;
          this.shifted = false;
          this.changed();
        },
      })}
      ${this.state()}
      ${applyBar({ ready: this.pending, busy: this.previews.committing, apply: () => void this.commit(), drop: () => this.drop() })}`;
  }

  private state(): TemplateResult | typeof nothing {
    if (!this.pending) return nothing;
    if (this.previews.error) return note(this.previews.error, "tool-state", true);
    const { removed } = this.previews;
    if (removed > 0) return note(`${countOf(removed, "point")} would be removed`, "tool-state");
    return note(this.all ? "No points there" : "No added points there; Shift takes those of the scan too", "tool-state");
  }
}

export const erase = register((context) => new EraseTool(context));
