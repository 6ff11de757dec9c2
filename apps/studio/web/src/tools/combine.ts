// Set operations with a second solid: a cloud, a mesh or a generated shape, placed by a gizmo.
import { type TemplateResult, html } from "lit";
import type { BooleanOperation, Box, Operation } from "../engine/protocol";
import { segmentsRow, selectRow } from "../ui/controls";
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
  readonly hint = "Choose a second solid, place it by the gizmo, choose what is made of both; Enter combines, Esc drops";
  private kind: Kind = "union";
  private creases: "sampled" | "none" = "sampled";

  constructor(context: ToolContext) {
    super(context, "solid", ["cloud", "mesh"]);
  }

  /// In the middle of the scene: there it meets the surface.
  protected firstPlace(extent: Box): Pose {
    return this.posed(centreOf(this.context.viewport.box), this.fitting(extent, 0.4));
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
      ${this.part ? this.gizmo.fields(this.part.pose, diagonalOf(this.context.viewport.box) / 200) : ""}
      ${note(this.state(), "tool-state", this.previews.error !== "")}
      ${applyBar({ ready: !!this.part, busy: this.previews.committing, label: "Combine", apply: () => void this.commit(), drop: () => this.drop() })}`;
  }

  private state(): string {
    if (this.previews.error) return this.previews.error;
    if (this.measuring) return "Reading…";
    if (!this.part) return "Choose a second solid";
    return kKinds.find((kind) => kind.value === this.kind)!.title;
  }
}

export const combine = register((context) => new CombineTool(context));
