// What the colours on the surface mean, in numbers.
import { css, html, nothing } from "lit";
import { customElement } from "lit/decorators.js";
import { measure } from "../ui/format";
import { base } from "../ui/styles";
import { mapColour } from "../view/colours";
import { Part } from "./context";

@customElement("psk-legend")
export class Legend extends Part {
  static override styles = [
    base,
    css`
      :host {
        position: absolute;
        left: 12px;
        top: 12px;
        pointer-events: none;
      }
      figure {
        margin: 0;
        padding: 8px 12px;
        border-radius: 5px;
        background: color-mix(in srgb, var(--panel) 86%, transparent);
        border: 1px solid var(--line);
        font-size: 12px;
        width: 208px;
      }
      canvas {
        width: 100%;
        height: 10px;
        display: block;
        border-radius: 2px;
        margin: 4px 0;
      }
      div {
        display: flex;
        justify-content: space-between;
        color: var(--text-2);
      }
    `,
  ];

  override render() {
    const { legend } = this.store;
    if (!legend) return nothing;
    const middle = (legend.low + legend.high) / 2;
    return html`<figure data-testid="legend" aria-label=${`Colours: ${legend.title} from ${measure(legend.low)} to ${measure(legend.high)}`}>
      ${legend.title}
      <canvas width="128" height="1" aria-hidden="true"></canvas>
      <div><span>${measure(legend.low)}</span><span>${measure(middle)}</span><span>${measure(legend.high)}</span></div>
    </figure>`;
  }

  override updated(): void {
    const canvas = this.renderRoot.querySelector("canvas");
    const context = canvas?.getContext("2d");
    if (!canvas || !context) return;
    for (let x = 0; x < canvas.width; ++x) {
      const [r, g, b] = mapColour(x / (canvas.width - 1)).map((v) => Math.round(255 * v));
      context.fillStyle = `rgb(${r} ${g} ${b})`;
      context.fillRect(x, 0, 1, 1);
    }
  }
}
