// The axes in the corner: they turn with the view, and a click on one looks along it.
import { css, html, svg } from "lit";
import { customElement } from "lit/decorators.js";
import type { Vec3 } from "../engine/protocol";
import { base } from "../ui/styles";
import { Part } from "./context";

interface End {
  name: string;
  axis: Vec3;
  positive: boolean;
}
const kEnds: End[] = ["x", "y", "z"].flatMap((name, i) =>
  [1, -1].map((sign) => ({ name, axis: [0, 1, 2].map((k) => (k === i ? sign : 0)) as Vec3, positive: sign > 0 })),
);
const kLength = 30;

@customElement("psk-view-gizmo")
export class ViewGizmo extends Part {
  static override styles = [
    base,
    css`
      :host {
        position: absolute;
        right: 8px;
        top: 8px;
        width: 88px;
        text-align: center;
        font-size: 11px;
        line-height: 14px;
        color: var(--text-2);
        pointer-events: none;
      }
      svg {
        width: 88px;
        height: 88px;
        display: block;
      }
      line {
        stroke-width: 2;
      }
      .projection {
        pointer-events: auto;
        border: 0;
        padding: 2px 4px;
        border-radius: 3px;
        background: none;
        color: inherit;
        font: inherit;
      }
      .projection:hover {
        background: var(--control-hover, rgb(128 128 128 / 20%));
        color: var(--text);
      }
      g[role="button"] {
        pointer-events: auto;
        outline-offset: -4px;
      }
      .x {
        stroke: var(--orange);
        fill: var(--orange);
      }
      .y {
        stroke: var(--text-3);
        fill: var(--text-3);
      }
      .z {
        stroke: var(--blue);
        fill: var(--blue);
      }
      .minus {
        fill: var(--panel);
      }
      text {
        stroke: none;
        fill: #14171b;
        font-weight: 600;
        font-size: 11px;
        text-anchor: middle;
        dominant-baseline: central;
      }
    `,
  ];
  private stop = () => undefined as unknown;
  private seen = "";

  override connectedCallback(): void {
    super.connectedCallback();
    this.stop = this.context.viewport.onFrame(() => {
      const { azimuth, elevation, orthographic, up } = this.context.viewport.view;
      const now = `${azimuth},${elevation},${orthographic},${up}`;
      if (now !== this.seen) this.requestUpdate();
      this.seen = now;
    });
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    this.stop();
  }

  override render() {
    const [right, up, back] = this.context.viewport.view.frame();
    const dot = (a: Vec3, b: Vec3) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const ends = kEnds.map((end) => ({ ...end, x: kLength * dot(right, end.axis), y: -kLength * dot(up, end.axis), depth: dot(back, end.axis) }));
    ends.sort((a, b) => a.depth - b.depth);
    const projection = this.context.viewport.view.orthographic ? "orthographic" : "perspective";
    return html`<svg viewBox="-44 -44 88 88" aria-label="Axes" role="group">
        ${ends.map(
          (end) => svg`<g role="button" tabindex="-1" class=${end.name} aria-label=${`View along ${end.positive ? "" : "minus "}${end.name}`}
            data-testid=${`axis-${end.positive ? "" : "minus-"}${end.name}`} @click=${() => this.look(end.axis)}>
            ${end.positive ? svg`<line x1="0" y1="0" x2=${end.x} y2=${end.y}></line>` : null}
            <circle class=${end.positive ? "" : "minus"} cx=${end.x} cy=${end.y} r=${end.positive ? 8 : 6} stroke-width="1.5"></circle>
            ${end.positive ? svg`<text x=${end.x} y=${end.y}>${end.name.toUpperCase()}</text>` : null}</g>`,
        )}
      </svg>
      <button
        class="projection"
        data-testid="projection"
        data-value=${projection}
        title="Perspective or orthographic (5)"
        aria-label=${`Projection: ${projection}`}
        @click=${() => this.context.run("projection")}
      >
        ${projection}
      </button>`;
  }

  private look(axis: Vec3): void {
    const { viewport } = this.context;
    const goal = viewport.view.clone();
    goal.setDirection([0, 0, 0, 0, 0, 0, 0, 0, ...axis, 0, 0, 0, 0, 1]);
    viewport.flyTo(goal);
  }
}
