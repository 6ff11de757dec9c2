// The bar at the bottom: what runs, what there is, what each stage took, on which device.
import { css, html, nothing } from "lit";
import { customElement } from "lit/decorators.js";
import { isCoarser } from "../engine/store";
import { count, duration, percent } from "../ui/format";
import { styled } from "../ui/styled";
import { base } from "../ui/styles";
import { Part, tell } from "./context";
import { stageShares } from "./stages";

@customElement("psk-status-bar")
export class StatusBar extends Part {
  static override styles = [
    base,
    css`
      :host {
        display: flex;
        align-items: center;
        gap: 16px;
        padding: 0 12px;
        background: var(--bar);
        border-top: 1px solid var(--line);
        font-size: 12px;
        white-space: nowrap;
        overflow: hidden;
      }
      .left {
        flex: 1 1 auto;
        min-width: 0;
        display: flex;
        align-items: center;
        gap: 8px;
        overflow: hidden;
      }
      .tip {
        color: var(--text-3);
        overflow: hidden;
        text-overflow: ellipsis;
      }
      .track {
        position: relative;
        width: 140px;
        height: 6px;
        border-radius: 3px;
        background: var(--field);
        border: 1px solid var(--line);
        overflow: hidden;
        flex: none;
      }
      .done {
        position: absolute;
        inset: 0 auto 0 0;
        background: var(--orange);
      }
      .cancel {
        height: 20px;
        padding: 0 8px;
        font-size: 12px;
      }
      .fact b {
        font-weight: 500;
        color: var(--text);
      }
      .fact {
        color: var(--text-3);
      }
      .stages {
        display: flex;
        width: 120px;
        height: 10px;
        border-radius: 2px;
        overflow: hidden;
        background: var(--field);
        gap: 1px;
      }
      .stages i {
        display: block;
        min-width: 1px;
      }
      .octree {
        background: #274f7d;
      }
      .splat {
        background: #3473ad;
      }
      .solve {
        background: #5aa5e0;
      }
      .extract {
        background: #a5cdee;
      }
      .encode {
        background: #7a4a1e;
      }
      .transfer {
        background: #b4672b;
      }
      .decode {
        background: #e8833a;
      }
      .draw {
        background: #f6bd92;
      }
      .times {
        display: flex;
        align-items: center;
        gap: 8px;
        color: var(--text-2);
      }
      .fact,
      .times,
      .device {
        flex: none;
      }
      .device {
        color: var(--text-2);
        max-width: 30ch;
        overflow: hidden;
        text-overflow: ellipsis;
      }
    `,
  ];

  override render() {
    return html`<div class="left">${this.store.progress ? this.progress() : this.tip()}</div>
      ${this.counts()} ${this.times()} ${this.device()}`;
  }

  private tip() {
    const hint = this.context.tool()?.hint ?? "";
    return html`<span class="tip" title=${hint} data-testid="hint">${hint}</span>`;
  }

  private progress() {
    const { phase = "working", fraction = 0, eta_ms } = this.store.progress ?? {};
    const rest = eta_ms && eta_ms > 400 && fraction > 0.2 ? `${duration(eta_ms)} left` : "";
    const cancel = () => void this.context.connection.request("cancel").catch((error) => tell(this.context, error));
    return html`<span data-testid="progress" class="left" role="status">
      <span class="track" role="progressbar" aria-label="Progress" aria-valuenow=${Math.round(100 * fraction)}
        ><span class="done" ${styled({ width: `${100 * fraction}%` })}></span
      ></span>
      <span>${phase} ${percent(fraction)}</span><span class="tip">${rest}</span>
      <button class="button cancel" data-testid="cancel" title="Cancel (Esc)" @click=${cancel}>Cancel</button>
    </span>`;
  }

  private fact(name: string, value: number | undefined, testid: string) {
    const text = value === undefined ? "–" : count(value);
    return html`<span class="fact">${name} <b data-testid=${testid}>${text}</b></span>`;
  }

  private counts() {
    const { scene, mesh } = this.store;
    if (!scene) return nothing;
    const topology = scene.topology ?? undefined;
    return html`${this.fact("points", scene.points, "status-points")}
    ${this.fact("triangles", mesh?.preview ? mesh.triangles : scene.triangles, "status-triangles")}
    ${mesh && isCoarser(mesh) ? html`<span class="fact coarser" title="Too many to draw: a surface of less depth is shown, the whole one is saved"
      ><b data-testid="status-shown">${count(mesh.triangles)}</b> shown</span>` : nothing}
    ${this.fact("genus", topology?.genus, "status-genus")} ${this.fact("components", topology?.components, "status-components")}`;
  }

  private times() {
    const ms = this.store.mesh?.ms;
    const shares = ms ? stageShares(ms) : [];
    if (!ms || shares.length === 0) return nothing;
    const sum = shares.reduce((total, share) => total + share.ms, 0);
    const table = shares.map(({ stage, ms: value }) => `${stage}: ${duration(value)}`).join("\n");
    return html`<span class="times" title=${table} data-testid="status-times">
      <span class="stages" role="img" aria-label=${`Times of the stages: ${table.replaceAll("\n", ", ")}`}
        >${shares.map(({ stage, share }) => html`<i class=${stage} ${styled({ flex: String(share) })}></i>`)}</span
      >${duration(sum)}</span
    >`;
  }

  private device() {
    const { hello, connection } = this.store;
    const text = connection === "open" ? (hello?.device ?? "") : connection === "lost" || connection === "refused" ? "not connected" : "connecting";
    return html`<span class="device" data-testid="status-device" title=${text}>${text}</span>`;
  }
}
