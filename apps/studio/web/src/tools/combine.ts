// Set operations with a second solid: a cloud, a mesh or a generated shape, placed by a gizmo.
import { type TemplateResult, html, nothing } from "lit";
import type { BooleanOperation, Box, ClassCounts, Operation } from "../engine/protocol";
import { segmentsRow, selectRow } from "../ui/controls";
import { count } from "../ui/format";
import { booleanOf } from "./shared/documents";
import { applyBar, note } from "./shared/fields";
import { centreOf, diagonalOf } from "./shared/interval";
import { type PlacedPart, PlacedTool } from "./shared/placed_tool";
import type { Pose } from "./shared/pose";
import { register } from "./registry";
import type { ToolContext } from "./tool";

type Kind = BooleanOperation["operation"];

const kKinds: { value: Kind; label: string; title: string }[] = [
  { value: "union", label: "Union", title: "What is in either" },
  { value: "intersection", label: "Intersection", title: "What is in both" },
  { value: "difference", label: "Difference", title: "What is in the scene and not in the second solid" },
  { value: "symmetric", label: "Symmetric difference", title: "What is in exactly one of them" },
];

class CombineTool extends PlacedTool {
  readonly id = "combine";
  readonly title = "Combine solids";
  readonly key = "u";
  readonly icon = "M15 9.5a6 6 0 11-6-6 6 6 0 016 6zM21 14.5a6 6 0 11-6-6 6 6 0 016 6z";
  readonly hint = "Choose a second solid, place it by the gizmo; Enter combines, Esc drops";
  private kind: Kind = "union";
  private asItIs = false;
  private creases: "sampled" | "none" = "sampled";

  constructor(context: ToolContext) {
    super(context, "solid", ["cloud", "mesh"]);
  }

  /// In the middle of the scene: there it meets the surface.
  protected firstPlace(extent: Box): Pose {
    const scale = this.asItIs ? 1 : this.fitting(extent, 0.4);
    this.asItIs = false;
    return this.posed(centreOf(this.context.viewport.box), scale);
  }

  /// A mesh without normals has no points to show: it stays where it is by itself.
  protected override unseen(): Box {
    this.asItIs = true;
    return this.context.viewport.box;
  }

  protected renewed(): void {}

  protected operation({ source, pose, pivot }: PlacedPart): Operation {
    return booleanOf({ operation: this.kind, source, pose, pivot, creases: this.creases });
  }

  settings(): TemplateResult {
    return html`
      ${this.picker.template()}
      ${selectRow<Kind>({
        label: "Result",
        testid: "combine-operation",
        value: this.kind,
        choices: kKinds,
        change: (kind) => {
          this.kind = kind;
          this.preview();
        },
      })}
      ${segmentsRow<"sampled" | "none">({
        label: "Creases",
        testid: "combine-creases",
        value: this.creases,
        choices: [
          { value: "sampled", label: "Sharp", title: "Samples are added where the surfaces cross" },
          { value: "none", label: "Rounded", title: "Nothing is added where the surfaces cross" },
        ],
        change: (creases) => {
          this.creases = creases;
          this.preview();
        },
      })}
      ${this.part ? this.gizmo.fields(this.part.pose, diagonalOf(this.context.viewport.box) / 200) : nothing}
      ${this.part ? this.counts() : nothing}
      ${note(this.state(), "tool-state", this.previews.error !== "")}
      ${applyBar({ ready: !!this.part, busy: this.previews.committing, label: "Combine", apply: () => void this.commit(), drop: () => this.drop() })}`;
  }

  /// What becomes of the points, in the colours that they have in the view.
  private counts(): TemplateResult | typeof nothing {
    const { ghosts } = this.context.store;
    if (!ghosts?.a || !ghosts.b) return nothing;
    const sum = (what: keyof ClassCounts) => (ghosts.a?.[what] ?? 0) + (ghosts.b?.[what] ?? 0);
    const dot = (colour: string) => html`<svg width="10" height="10" viewBox="0 0 10 10" aria-hidden="true"><circle cx="5" cy="5" r="4" fill=${colour} /></svg>`;
    return html`<p class="hint" data-testid="combine-counts">
      ${dot("#d3d8df")} ${count(sum("kept"))} kept &nbsp; ${dot("#f0954e")} ${count(sum("flipped"))} turned &nbsp; ${dot("#4aa3ea")} ${count(sum("dropped"))} dropped
    </p>`;
  }

  private state(): string {
    if (this.previews.error) return this.previews.error;
    if (this.measuring) return "Reading…";
    if (!this.part) return "Choose a second solid";
    return kKinds.find((kind) => kind.value === this.kind)!.title;
  }
}

export const combine = register((context) => new CombineTool(context));
