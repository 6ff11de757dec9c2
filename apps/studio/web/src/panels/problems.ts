// Where the surface is a guess, the worst first: a click flies there and offers the tool that mends it.
import { css, html, nothing } from "lit";
import type { StudioContext } from "../app/context";
import { tell } from "../app/context";
import type { ProblemRegion } from "../engine/protocol";
import { button } from "../ui/controls";
import { count, measure } from "../ui/format";

export const problemStyles = css`
  .problems {
    list-style: none;
    margin: 4px -4px;
    padding: 0;
  }
  .problem {
    display: grid;
    grid-template-columns: 24px minmax(0, 1fr) 64px;
    gap: 8px;
    align-items: center;
    width: 100%;
    padding: 4px 8px;
    border: 0;
    border-radius: 5px;
    background: none;
    text-align: left;
  }
  .problem:hover {
    background: var(--hover);
  }
  .problem[aria-current="true"] {
    background: color-mix(in srgb, var(--orange) 22%, var(--panel));
  }
  .problem .rank {
    color: var(--text-3);
    text-align: right;
  }
`;

/// Turns the view to the region's best view and frames it.
function fly(context: StudioContext, region: ProblemRegion, index: number): void {
  const { viewport, store } = context;
  const goal = viewport.view.clone();
  const view = region.views[0];
  if (view) goal.setDirection(view.matrix);
  goal.fit({ lower: region.lower, upper: region.upper });
  goal.distance *= 2; // half of the picture's width: what is around says where one is
  goal.target = region.centroid;
  viewport.flyTo(goal);
  store.update({ problem: index });
}

function item(context: StudioContext, region: ProblemRegion, index: number, most: number) {
  const share = most > 0 ? Math.max(Math.round((20 * region.score) / most), 1) : 1;
  return html`<li>
    <button
      class="problem"
      data-testid="problems-item-${index}"
      aria-current=${String(index === context.store.problem)}
      title="Fly there"
      @click=${() => fly(context, region, index)}
    >
      <span class="rank">${index + 1}</span>
      <span>${count(region.triangles)} triangles<br /><span class="hint">weakness ${region.peak.toFixed(2)}, area ${measure(region.area)}</span></span>
      <svg viewBox="0 0 20 3" preserveAspectRatio="none" width="64" height="6" role="img" aria-label="Score ${measure(region.score)}">
        <rect width="20" height="3" fill="var(--field)"></rect><rect width=${share} height="3" fill="var(--orange)"></rect>
      </svg>
    </button>
  </li>`;
}

/// A region that is broad wants an area, one that is long a stroke.
export function fittingTool(region: ProblemRegion): "stroke" | "lasso" {
  const size = region.upper.map((value, i) => value - region.lower[i]!).sort((a, b) => b - a);
  return (size[1] ?? 0) > 0.5 * (size[0] ?? 1) ? "lasso" : "stroke";
}

function offer(context: StudioContext) {
  const { problem, problems } = context.store;
  const region = problems?.[problem];
  if (!region) return nothing;
  const id = fittingTool(region);
  const tool = context.tools.find((candidate) => candidate.id === id);
  if (!tool) return nothing;
  return html`<div class="actions">${button({ label: `Guide it: ${tool.title}`, testid: "problem-tool", primary: true, run: () => context.chooseTool(id) })}</div>`;
}

export function problemsPanel(context: StudioContext) {
  const { connection, store } = context;
  const { problems } = store;
  const find = () => {
    connection
      .request("problems")
      .then(({ regions }) => store.update({ problems: regions, problem: -1 }))
      .catch((error) => tell(context, error));
  };
  if (!store.mesh) return html`<p class="hint">No surface yet.</p>`;
  const most = problems?.[0]?.score ?? 0;
  return html`<p class="hint">Where samples are sparse and the field is flat the topology is a guess.</p>
    <div class="actions">${button({ label: problems ? "Find again" : "Find problems", testid: "find-problems", primary: !problems, run: find })}</div>
    ${problems?.length === 0 ? html`<p data-testid="no-problems">Nothing is doubtful.</p>` : nothing}
    ${problems?.length ? html`<ol class="problems" aria-label="Problems, the worst first">${problems.map((region, i) => item(context, region, i, most))}</ol>` : nothing}
    ${offer(context)}`;
}
