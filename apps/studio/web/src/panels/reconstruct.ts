// How the surface is made. Every control is live.
import { css, html, nothing, svg } from "lit";
import type { StudioContext } from "../app/context";
import { tell } from "../app/context";
import { EngineError } from "../engine/connection";
import { surfaceKey } from "../engine/link";
import type { Options } from "../engine/protocol";
import { segmentsRow, slider, sliderRow, numberField, switchRow } from "../ui/controls";
import { bytes, duration, percent } from "../ui/format";
import { densityOf, placeOf } from "./histogram";
import { normalsCard } from "./normals_card";

export const reconstructStyles = css`
  .cost {
    display: flex;
    justify-content: space-between;
    padding-left: 104px;
  }
  .pending {
    color: var(--orange-text);
  }
  .histogram {
    display: block;
    width: 100%;
    height: 56px;
    background: var(--field);
    border: 1px solid var(--line);
    border-radius: 5px;
    margin-top: 4px;
  }
  .histogram rect {
    fill: var(--blue);
  }
  .histogram rect.goes {
    fill: var(--orange);
  }
  .histogram line {
    stroke: var(--orange-text);
    stroke-width: 1;
    vector-effect: non-scaling-stroke;
  }
`;

type NumberKey = "depth" | "screening" | "samples_per_node" | "iterations" | "trim";
interface Range {
  label: string;
  min: number;
  max: number;
  hardMax?: number;
  step: number;
  fallback: number;
  title: string;
}
const kRanges: Record<Exclude<NumberKey, "trim">, Range> = {
  depth: { label: "Depth", min: 5, max: 12, hardMax: 14, step: 1, fallback: 8, title: "Depth of the octree: cells of the finest level are the scene's width / 2^depth" },
  screening: { label: "Screening", min: 0, max: 16, hardMax: 1000, step: 0.5, fallback: 4, title: "How much the surface is pulled to the points; 0: unscreened Poisson" },
  samples_per_node: { label: "Samples/node", min: 1, max: 20, hardMax: 1000, step: 0.5, fallback: 1.5, title: "Points that a finest cell should have; more smooths noise away" },
  iterations: { label: "Iterations", min: 1, max: 32, hardMax: 1000, step: 1, fallback: 8, title: "Of the solver at each depth" },
};

function live({ live: options }: StudioContext, key: keyof Options) {
  return {
    input: (value: unknown) => options.input({ [key]: value }),
    change: (value: unknown) => options.change({ [key]: value }),
  };
}

function numeric(context: StudioContext, key: Exclude<NumberKey, "trim">) {
  const { fallback, ...range } = kRanges[key];
  const value = Number(context.store.options[key] ?? fallback);
  return sliderRow({ ...range, value, testid: `opt-${key.replaceAll("_", "-")}`, ...live(context, key) });
}

function depthCost({ store }: StudioContext) {
  const depth = Number(store.options.depth ?? 8);
  const cost = store.estimate?.depths.find((entry) => entry.depth === depth);
  if (!cost) return nothing;
  return html`<div class="cost hint" data-testid="depth-cost" title="Expected on this device, from the cloud's points"><span>${cost.bytes === null ? "more than any memory" : `about ${bytes(cost.bytes)}`}</span><span>${cost.ms === null ? "" : duration(cost.ms)}</span></div>`;
}

/// The bars, what goes in orange.
function bars({ store }: StudioContext, trim: number) {
  const histogram = store.histogram;
  if (!histogram) return nothing;
  const { counts } = histogram.densities;
  const most = Math.max(...counts, 1e-9);
  const edge = trim > 0 ? placeOf(histogram, densityOf(histogram, trim)) : 0;
  const label = trim > 0 ? `Densities; what is sparser than ${densityOf(histogram, trim).toPrecision(3)} goes` : "Densities of the surface";
  return html`<svg class="histogram" viewBox="0 0 ${counts.length} 40" preserveAspectRatio="none" role="img" aria-label=${label} data-testid="trim-histogram">
    ${counts.map((value, i) => {
      const height = 38 * Math.sqrt(value / most);
      return svg`<rect class=${(i + 0.5) / counts.length < edge ? "goes" : ""} x=${i + 0.08} y=${40 - height} width="0.84" height=${height}></rect>`;
    })}
    ${trim > 0 ? svg`<line x1=${edge * counts.length} x2=${edge * counts.length} y1="0" y2="40"></line>` : nothing}
  </svg>`;
}

/// Tints what a trim would cut away, once the mesh on the screen has the densities.
function showTrim({ store, viewport }: StudioContext): void {
  const trim = store.pendingOptions?.trim;
  const { histogram } = store;
  viewport.setTrim(trim !== undefined && trim > 0 && histogram ? densityOf(histogram, trim) : -1);
}

/// The hand is on the trim: the engine sends the whole surface with its densities, once; all else the page shows itself.
function holdTrim(context: StudioContext, trim: number): void {
  const { store, connection, viewport, live: options } = context;
  const first = store.pendingOptions?.trim === undefined;
  if (!store.histogram) return options.input({ trim });
  options.hold({ trim });
  if (first && !viewport.surface.decoded?.values["density"]) {
    connection.request("values", { name: "density" }).catch((error) => tell(context, error));
  }
}

function trimControl(context: StudioContext) {
  const trim = Number(context.store.options.trim ?? 0);
  const spec = {
    label: "Trim",
    testid: "opt-trim",
    title: "Cuts away where the surface is sparser than this share of it; what goes is orange",
    value: trim,
    min: 0,
    max: 0.5,
    step: 0.005,
    input: (value: number) => holdTrim(context, value),
    change: (value: number) => context.live.change({ trim: value }),
  };
  return html`<h3>Trim</h3>
    ${bars(context, trim)}
    <div class="slide">${slider({ ...spec, text: percent(trim) })}${numberField({ ...spec, label: "Trim, number", testid: "opt-trim-number", max: 0.99 })}</div>
    <p class="hint">${trim > 0 ? `The sparsest ${percent(trim)} of the surface goes` : "Nothing is cut away"}</p>`;
}

function fieldRow(context: StudioContext) {
  return segmentsRow({
    label: "Field",
    testid: "opt-field",
    title: "Poisson closes holes smoothly; distance follows the points closely",
    value: context.store.options.field ?? "poisson",
    choices: [
      { value: "poisson", label: "Poisson" },
      { value: "distance", label: "Distance" },
    ],
    change: live(context, "field").change,
  });
}

export function reconstructPanel(context: StudioContext) {
  const { options, pendingOptions, scene } = context.store;
  if (!scene) return html`<p class="hint">Open a cloud to reconstruct its surface.</p>`;
  return html`${normalsCard(context)}
    <h3>Octree</h3>
    ${numeric(context, "depth")} ${depthCost(context)} ${numeric(context, "samples_per_node")}
    <h3>Solve</h3>
    ${fieldRow(context)}
    ${numeric(context, "screening")} ${numeric(context, "iterations")}
    ${segmentsRow({
      label: "Boundary",
      testid: "opt-boundary",
      title: "Free: the surface may leave the scene's box. Dirichlet: it closes within it",
      value: options.boundary ?? "free",
      choices: [
        { value: "free", label: "Free" },
        { value: "dirichlet", label: "Dirichlet" },
      ],
      change: live(context, "boundary").change,
    })}
    ${switchRow({
      label: "Fixed screening",
      testid: "opt-fixed-screening",
      title: "The same screening at every depth",
      value: options.fixed_screening === true,
      change: live(context, "fixed_screening").change,
    })}
    ${trimControl(context)}
    ${pendingOptions ? html`<p class="hint pending" data-testid="options-pending">Not applied yet. Esc goes back.</p>` : nothing}`;
}

const asked = new WeakMap<StudioContext, { estimate: string; histogram: string }>();

/// Asks for what the panel shows besides the options, once for every cloud and mesh.
export function refreshReconstruct(context: StudioContext): void {
  const { store, connection } = context;
  const { scene, mesh } = store;
  showTrim(context);
  if (store.panel !== "reconstruct" || !scene || store.connection !== "open") return;
  const before = asked.get(context) ?? { estimate: "", histogram: "" };
  const depth = Number(store.options.depth ?? 8);
  const key = `${scene.journal} ${scene.points} ${depth} ${JSON.stringify(scene.options)}`;
  const surface = mesh && !mesh.preview ? surfaceKey(scene) : before.histogram;
  asked.set(context, { estimate: key, histogram: surface });
  if (key !== before.estimate) {
    connection.request("estimate", { options: { depth } }).then((estimate) => store.update({ estimate })).catch((error) => tell(context, error));
  }
  if (surface !== before.histogram) {
    connection.request("histogram").then((histogram) => store.update({ histogram })).catch((error) => {
      // Something more urgent came between: asked again with the next change.
      if (error instanceof EngineError && error.quiet) asked.delete(context);
      else store.update({ histogram: null });
    });
  }
}
