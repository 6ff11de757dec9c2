// What was read, and how the points are drawn.
import { html } from "lit";
import type { StudioContext } from "../app/context";
import type { CloudInfo, Vec3 } from "../engine/protocol";
import { button, facts, segmentsRow, selectRow, sliderRow } from "../ui/controls";
import { count, measure } from "../ui/format";
import { normalsCard } from "./normals_card";

const place = (v: Vec3) => v.map(measure).join(", ");

function cloud(info: CloudInfo) {
  const size = info.box.upper.map((value, i) => value - info.box.lower[i]!) as Vec3;
  const shifted = info.shift.some((value) => value !== 0);
  const rows: [string, unknown, string?][] = [
    ["Points", count(info.points), "cloud-points"],
    ["Normals", info.normals ? "yes" : "none"],
    ["Size", size.map(measure).join(" × ")],
    ["From", place(info.box.lower)],
    ["To", place(info.box.upper)],
    ["Dropped", count(info.dropped), "cloud-dropped"],
  ];
  if (shifted) rows.push(["Shift", place(info.shift)]);
  return html`<h3>${info.name}</h3>
    ${facts(rows)}`;
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
      value: view.show === "mesh" ? "no" : "yes",
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
    ${scene.clouds.map(cloud)}`;
}
