// Every step with what it did; a click goes there, those undone are faint.
import { css, html, nothing } from "lit";
import type { StudioContext } from "../app/context";
import { tell } from "../app/context";
import type { HistoryStep, Operation, Options } from "../engine/protocol";
import { chipText } from "../app/chip";
import { duration } from "../ui/format";

export const historyStyles = css`
  .history {
    list-style: none;
    margin: 0 -4px;
    padding: 0;
  }
  .step {
    display: grid;
    grid-template-columns: 24px minmax(0, 1fr) auto;
    gap: 0 8px;
    width: 100%;
    padding: 4px 8px;
    border: 0;
    border-radius: 5px;
    background: none;
    text-align: left;
  }
  .step:hover {
    background: var(--hover);
  }
  .step .hint {
    grid-column: 2 / 4;
    white-space: normal;
  }
  .step .rank,
  .step .ms {
    color: var(--text-3);
    text-align: right;
  }
  .step[aria-current="step"] {
    background: color-mix(in srgb, var(--blue) 24%, var(--panel));
  }
  .step.undone > * {
    color: var(--text-3);
    font-style: italic;
  }
`;

const kShown = ["op"];

function changed(options: Options): string {
  return Object.entries(options)
    .filter(([key]) => !kShown.includes(key))
    .map(([key, value]) => `${key.replaceAll("_", " ")} ${typeof value === "boolean" ? (value ? "on" : "off") : String(value)}`)
    .join(", ");
}

/// What an operation is called in the list.
export function operationTitle(operation: Operation): string {
  switch (operation.op) {
    case "guide":
      return operation.normals === "stroke" ? "Guide by a stroke" : "Guide";
    case "remove":
      return operation.originals ? "Erase points" : "Erase added points";
    case "flip":
      return "Turn normals of a selection";
    case "insert":
      return `Copy part of ${operation.shape ?? operation.file?.split("/").pop() ?? "a cloud"}`;
    case "deform":
      return operation.handles?.length ? "Bend by handles" : "Bend by a lattice";
    case "boolean":
      return operation.operation.charAt(0).toUpperCase() + operation.operation.slice(1);
    case "orient":
      return { estimate: "Estimate normals", repair: "Repair normals", turn: "Turn all normals round" }[operation.method];
    case "options":
      return `Set ${changed(operation)}`;
  }
}

function step(context: StudioContext, entry: HistoryStep | null, index: number, done: number) {
  const { connection, store } = context;
  const go = () => void connection.request("go", { done: index }).catch((error) => tell(context, error));
  const title = entry ? operationTitle(entry.operation) : `Opened ${store.scene?.base_label ?? ""}`;
  const record = entry?.record;
  return html`<li>
    <button
      class="step ${index > done ? "undone" : ""}"
      data-testid="history-item-${index}"
      aria-current=${index === done ? "step" : nothing}
      title=${index === done ? "The scene is here" : index < done ? "Go back to here" : "Do again up to here"}
      @click=${go}
    >
      <span class="rank">${index}</span><span>${title}</span><span class="ms">${record ? duration(record.total_ms) : ""}</span>
      ${record ? html`<span class="hint">${chipText(record)}</span>` : nothing} ${(record?.notes ?? []).map((note) => html`<span class="hint">${note}</span>`)}
    </button>
  </li>`;
}

export function historyPanel(context: StudioContext) {
  const { scene } = context.store;
  if (!scene) return html`<p class="hint">Nothing was done yet.</p>`;
  const key = (event: KeyboardEvent) => {
    const way = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (!way) return;
    event.preventDefault();
    const buttons = [...(event.currentTarget as HTMLElement).querySelectorAll<HTMLElement>("button")];
    buttons[buttons.indexOf(event.target as HTMLElement) + way]?.focus();
  };
  return html`<ol class="history" aria-label="Steps" @keydown=${key}>
    ${step(context, null, 0, scene.done)}${scene.history.map((entry, i) => step(context, entry, i + 1, scene.done))}
  </ol>`;
}
