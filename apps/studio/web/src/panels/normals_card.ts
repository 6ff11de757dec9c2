// What to do about a cloud without normals: they are estimated, on the side where the scanner stood if that is known.
import { html, nothing } from "lit";
import type { StudioContext } from "../app/context";
import { tell } from "../app/context";
import type { Vec3 } from "../engine/protocol";
import { button } from "../ui/controls";
import { measure } from "../ui/format";

interface CardState {
  sensors: Vec3[];
  waiting: boolean; // for a click
}

function stateOf({ store }: StudioContext): CardState {
  const state = (store.selection["normals-card"] ??= { sensors: [], waiting: false });
  return state as CardState;
}

/// The next click on the view says where the sensor was: the eye of the present view, or the place clicked.
function askForClick(context: StudioContext, state: CardState): void {
  state.waiting = true;
  context.store.update();
  const { canvas } = context.viewport;
  const take = (event: PointerEvent) => {
    event.stopImmediatePropagation();
    canvas.removeEventListener("pointerdown", take, true);
    const box = canvas.getBoundingClientRect();
    const pick = context.viewport.pick(event.clientX - box.left, event.clientY - box.top);
    state.waiting = false;
    if (pick) state.sensors = [...state.sensors, pick.point];
    else context.notice("info", "There is no point of the cloud under the cursor; the view's own place can be used instead");
    context.store.update();
  };
  canvas.addEventListener("pointerdown", take, true);
}

function estimate(context: StudioContext, state: CardState): void {
  const sensors = state.sensors.length > 0 ? { sensors: state.sensors } : {};
  context.connection
    .request("apply", { operation: { op: "orient", method: "estimate", ...sensors } })
    .then(() => (state.sensors = []))
    .catch((error) => tell(context, error));
}

export function normalsCard(context: StudioContext) {
  const { scene } = context.store;
  if (!scene || scene.normals || scene.points === 0) return nothing;
  const state = stateOf(context);
  const view = () => {
    state.sensors = [...state.sensors, context.viewport.view.eye];
    context.store.update();
  };
  return html`<section class="card" data-testid="normals-card" aria-label="Normals">
    <p>The cloud has no normals. A surface needs them.</p>
    ${state.sensors.map((sensor) => html`<p class="hint">Sensor at ${sensor.map(measure).join(", ")}</p>`)}
    <div class="actions">
      ${button({ label: "Estimate normals", testid: "estimate-normals", primary: true, run: () => estimate(context, state) })}
      ${button({ label: state.waiting ? "Click a place…" : "Sensor by a click", testid: "sensor-click", pressed: state.waiting, title: "The scanner stood where you click; sides are turned to it", run: () => askForClick(context, state) })}
      ${button({ label: "Sensor here", testid: "sensor-view", title: "The scanner stood where this view is seen from", run: view })}
    </div>
  </section>`;
}
