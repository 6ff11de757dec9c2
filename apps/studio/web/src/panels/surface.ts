// What the surface is, how it is drawn, and how far it is from a reference.
import { css, html, nothing } from "lit";
import type { StudioContext } from "../app/context";
import { tell } from "../app/context";
import type { Distances, Vec3 } from "../engine/protocol";
import { type ColourMode, isCoarser } from "../engine/store";
import { button, facts, segmentsRow, selectRow, slider, switchRow } from "../ui/controls";
import { bytes, count, measure } from "../ui/format";

export const comparisonStyles = css`
  table {
    width: 100%;
    border-collapse: collapse;
    font-size: 12px;
    margin: 4px 0;
  }
  th {
    font-weight: 400;
    color: var(--text-2);
    text-align: left;
    padding: 2px 0;
  }
  td,
  thead th + th {
    text-align: right;
    padding: 2px 0 2px 8px;
  }
  tbody tr {
    border-top: 1px solid var(--line);
  }
`;

const kColours: [ColourMode, string][] = [
  ["plain", "nothing (clay)"],
  ["colour", "colour of the points"],
  ["density", "density of the points"],
  ["confidence", "confidence"],
  ["weakness", "weakness"],
  ["distance", "distance to the points"],
];

interface SectionState {
  axis: "x" | "y" | "z";
  share: number; // of the box
  flipped: boolean;
}

function sectionOf({ store }: StudioContext): SectionState {
  return (store.selection["section-panel"] ??= { axis: "z", share: 0.5, flipped: false }) as SectionState;
}

/// Puts the plane where the panel says; takes it away when the section is off.
export function placeSection(context: StudioContext): void {
  const { viewport, store } = context;
  if (!store.view.section) return viewport.setSection(null);
  const { axis, share, flipped } = sectionOf(context);
  const i = { x: 0, y: 1, z: 2 }[axis];
  const { lower, upper } = viewport.box;
  const point = lower.map((value, k) => (k === i ? value + share * (upper[k]! - value) : (value + upper[k]!) / 2)) as Vec3;
  const normal = [0, 1, 2].map((k) => (k === i ? (flipped ? -1 : 1) : 0)) as Vec3;
  viewport.setSection({ point, normal });
}

function section(context: StudioContext) {
  const { store } = context;
  const state = sectionOf(context);
  const set = (patch: Partial<SectionState>) => {
    Object.assign(state, patch);
    placeSection(context);
    store.update();
  };
  const toggle = (on: boolean) => {
    store.setView({ section: on });
    placeSection(context);
  };
  return html`${switchRow({ label: "Section plane", testid: "section", value: store.view.section, change: toggle })}
  ${store.view.section
    ? html`${segmentsRow({ label: "Across", testid: "section-axis", value: state.axis, choices: ["x", "y", "z"].map((axis) => ({ value: axis as "x", label: axis.toUpperCase() })), change: (axis) => set({ axis }) })}
        <div class="row">
          <span class="label" aria-hidden="true">At</span>
          ${slider({ label: "Place of the section", testid: "section-place", min: 0, max: 1, value: state.share, input: (share) => set({ share }), change: (share) => set({ share }) })}
        </div>
        ${switchRow({ label: "Other side", testid: "section-flip", value: state.flipped, change: (flipped) => set({ flipped }) })}`
    : nothing}`;
}

function distances(name: string, { mean, rms, p95, max }: Distances) {
  return html`<tr><th scope="row">${name}</th>${[mean, rms, p95, max].map((value) => html`<td>${measure(value)}</td>`)}</tr>`;
}

function comparison(context: StudioContext) {
  const { connection, store } = context;
  const result = store.comparison;
  const compare = button({ label: "Compare with…", testid: "compare", disabled: !store.mesh, run: () => context.openDialog("reference") });
  if (!result) return html`<div class="actions">${compare}</div>`;
  const end = () => {
    void connection.request("reference_end").catch((error) => tell(context, error));
    store.update({ comparison: null, view: { ...store.view, colour: "plain" } });
  };
  return html`<table data-testid="comparison">
      <thead><tr><th scope="col">Distance</th>${["mean", "rms", "95 %", "max"].map((name) => html`<th scope="col">${name}</th>`)}</tr></thead>
      <tbody>${distances("to it", result.to_reference)}${distances("from it", result.from_reference)}${distances("both", result.two_sided)}</tbody>
    </table>
    ${facts([
      ["Precision", `${(100 * result.precision).toFixed(2)} %`],
      ["Recall", `${(100 * result.recall).toFixed(2)} %`],
      ["F-score", `${(100 * result.f_score).toFixed(2)} %`],
      ["Normals agree", result.normal_consistency === null ? "–" : result.normal_consistency.toFixed(4)],
    ])}
    <div class="actions">${compare}${button({ label: "End", testid: "reference-end", title: "Forget the reference", run: end })}</div>`;
}

export function surfacePanel(context: StudioContext) {
  const { store } = context;
  const { mesh, view, scene } = store;
  if (!scene || !mesh) return html`<p class="hint">No surface yet.</p>`;
  const { topology, surface } = scene;
  const coarser = isCoarser(mesh);
  const tight = surface?.watertight ?? context.viewport.surface.decoded?.closed;
  return html`<h3>Measures</h3>
    ${facts([
      ["Triangles", count(scene.triangles)],
      ["Vertices", surface ? count(surface.vertices) : "–"],
      ["Depth", coarser ? `${scene.options.depth ?? "–"}, shown at ${mesh.depth}` : mesh.depth],
      ["Genus", topology ? count(topology.genus) : "–"],
      ["Components", topology ? count(topology.components) : "–"],
      ["Euler number", topology ? topology.euler.toString().replace("-", "−") : "–"],
      ["Watertight", tight ? "yes" : surface ? `no, ${count(surface.boundary_edges)} open edges` : "no", "surface-watertight"],
      ["Area", surface ? measure(surface.area) : "–"],
      ["Volume", surface && surface.closed ? measure(surface.volume) : "–"],
      ["Sent", bytes(mesh.bytes)],
    ])}
    ${coarser ? html`<p class="hint" data-testid="shown-coarser">Shown with ${count(mesh.triangles)} triangles; saving writes all.</p>` : nothing}
    <h3>Drawing</h3>
    ${selectRow({
      label: "Colour by",
      testid: "surface-colour",
      value: view.colour,
      choices: kColours.map(([value, label]) => ({ value, label, disabled: value === "colour" && !store.meshAttributes.includes(value) })),
      change: (colour) => void context.link.colour(colour),
    })}
    ${switchRow({ label: "Wireframe", testid: "wireframe", title: "Edges of the triangles (Shift+W)", value: view.wireframe, change: (wireframe) => store.setView({ wireframe }) })}
    ${section(context)}
    <h3>Reference</h3>
    ${comparison(context)}`;
}
