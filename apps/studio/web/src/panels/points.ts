// What was read, and how the points are drawn.
import { html } from "lit";
import type { StudioContext } from "../app/context";
import type { SceneState, Vec3 } from "../engine/protocol";
import { button, facts, segmentsRow, selectRow, sliderRow } from "../ui/controls";
import { count, measure } from "../ui/format";
import { normalsCard } from "./normals_card";

const place = (v: Vec3) => v.map(measure).join(", ");

/// What was read, of all clouds together: they are merged.
function read(scene: SceneState) {
  const { lower, upper } = scene.box;
  const size = upper.map((value, i) => value - lower[i]!);
  const rows: [string, unknown, string?][] = [
    ["Points", count(scene.points), "cloud-points"],
    ["Normals", scene.normals ? "yes" : "none", "cloud-normals"],
    ["Size", size.map(measure).join(" × ")],
    ["From", place(lower)],
    ["To", place(upper)],
    ["Dropped", count(scene.dropped), "cloud-dropped"],
  ];
  if (scene.shift.some((value) => value !== 0)) rows.push(["Shift", place(scene.shift)]);
  return html`${scene.clouds.map((cloud) => html`<h3 title=${cloud.file || cloud.shape}>${cloud.name}</h3>`)} ${facts(rows)}`;
}

export function pointsPanel(context: StudioContext) {
  const { store, viewport } = context;
  const { scene, view } = store;
  if (!scene) return html`<p class="hint">No points yet.</p>`;
  const turn = () => void context.connection.request("apply", { operation: { op: "orient", method: "turn" } }).catch((e: Error) => context.notice("error", e.message));
  const repair = () => void context.connection.request("apply", { operation: { op: "orient", method: "repair" } }).catch((e: Error) => context.notice("error", e.message));
  return html`${normalsCard(context)}
    <h3>Drawing</h3>
    ${segmentsRow({
      label: "Show",
      testid: "points-show",
      value: view.show === "mesh" && viewport.surface.decoded?.triangles ? "no" : "yes",
      choices: [
        { value: "yes", label: "Shown" },
        { value: "no", label: "Hidden" },
      ],
      change: (value) => store.setView({ show: value === "no" ? "mesh" : "both" }),
    })}
    ${sliderRow({ label: "Size", testid: "points-size", unit: "px", min: 1, max: 12, step: 0.5, value: view.pointSize, input: (pointSize) => store.setView({ pointSize }), change: (pointSize) => store.setView({ pointSize }) })}
    ${selectRow({
      label: "Colour by",
      testid: "points-colour",
      value: view.pointColour,
      choices: [
        { value: "plain", label: "nothing" },
        { value: "colour", label: "their colour", disabled: !viewport.points.hasColours },
        { value: "normal", label: "normal" },
        { value: "added", label: "kind: cloud, guide, inserted" },
      ],
      change: (pointColour) => store.setView({ pointColour }),
    })}
    <p class="hint" data-testid="points-shown">${count(store.pointsShown)} of ${count(scene.points)} points are drawn</p>
    <div class="actions">
      ${button({ label: "Turn normals round", testid: "turn-normals", title: "All normals point to the other side: inside becomes outside", run: turn })}
      ${button({ label: "Repair normals", testid: "repair-normals", title: "Turns the normals that disagree with most around them", run: repair })}
    </div>
    ${read(scene)}`;
}
