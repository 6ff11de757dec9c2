// The row of a sequence or a simulation: play, step, loop, scrub; which frames are there already is shown.
import { css, html, nothing, svg } from "lit";
import { customElement } from "lit/decorators.js";
import type { SequenceState } from "../engine/store";
import { iconButton, slider } from "../ui/controls";
import { count, duration } from "../ui/format";
import { icons } from "../ui/icons";
import { base } from "../ui/styles";
import { Part } from "./context";
import { Player } from "./sequence";
import { stageShares } from "./stages";

/// Runs of cached frames as [first, after the last].
export function runsOf(cached: ReadonlySet<number>): [number, number][] {
  const runs: [number, number][] = [];
  for (const index of [...cached].sort((a, b) => a - b)) {
    const last = runs[runs.length - 1];
    if (last && last[1] === index) last[1] = index + 1;
    else runs.push([index, index + 1]);
  }
  return runs;
}

@customElement("psk-timeline")
export class Timeline extends Part {
  static override styles = [
    base,
    css`
      .bar {
        display: flex;
        align-items: center;
        gap: 8px;
        height: 44px;
        padding: 0 12px;
        background: var(--bar);
        border-top: 1px solid var(--line);
        white-space: nowrap;
      }
      .scrub {
        flex: 1 1 auto;
        position: relative;
        min-width: 80px;
      }
      .cached {
        position: absolute;
        left: 7px;
        right: 7px;
        bottom: 3px;
        width: calc(100% - 14px);
        height: 3px;
        fill: var(--orange);
        pointer-events: none;
      }
      .name {
        max-width: 20ch;
        overflow: hidden;
        text-overflow: ellipsis;
      }
      .count {
        min-width: 88px;
        text-align: right;
      }
    `,
  ];
  private player: Player | null = null;

  override render() {
    const { sequence } = this.store;
    if (!sequence) return nothing;
    this.player ??= new Player(this.context);
    return html`<div class="bar" role="group" aria-label="Timeline" data-testid="timeline">
      <span class="name" title=${sequence.name}>${sequence.name}</span>
      ${this.buttons(sequence, this.player)} ${sequence.frames > 0 ? this.scrub(sequence, this.player) : html`<span class="scrub"></span>`}
      ${this.numbers(sequence)}
      ${iconButton({ label: "Close the sequence", testid: "timeline-close", icon: icons.close, run: () => this.player?.stop() })}
    </div>`;
  }

  private buttons(sequence: SequenceState, player: Player) {
    const { playing, index, loop, kind } = sequence;
    const step = (by: number) => () => player.show(index + by);
    return html`${kind === "files" ? iconButton({ label: "Frame before", testid: "timeline-previous", icon: icons.previous, run: step(-1) }) : nothing}
    ${iconButton({ label: playing ? "Pause" : "Play", testid: "timeline-play", icon: playing ? icons.pause : icons.play, run: () => player.toggle() })}
    ${kind === "files" ? iconButton({ label: "Next frame", testid: "timeline-next", icon: icons.next, run: step(1) }) : nothing}
    ${kind === "files"
      ? iconButton({ label: "Loop", testid: "timeline-loop", icon: icons.loop, pressed: loop, run: () => this.store.update({ sequence: { ...sequence, loop: !loop } }) })
      : nothing}`;
  }

  private scrub(sequence: SequenceState, player: Player) {
    const show = (value: number) => player.show(Math.round(value));
    return html`<span class="scrub"
      >${slider({ label: "Frame", testid: "timeline-scrub", min: 0, max: sequence.frames - 1, step: 1, value: sequence.index, input: show, change: show })}
      <svg class="cached" viewBox="0 0 ${sequence.frames} 1" preserveAspectRatio="none" aria-hidden="true">
        ${runsOf(sequence.cached).map(([from, to]) => svg`<rect x=${from} width=${to - from} height="1"></rect>`)}
      </svg>
    </span>`;
  }

  private numbers({ index, frames, frame }: SequenceState) {
    const ms = frame ? stageShares(frame.ms).reduce((sum, stage) => sum + stage.ms, 0) : 0;
    return html`${frame ? html`<span class="hint">${frame.particles ? `${count(frame.particles)} particles, ` : ""}${count(frame.triangles)} triangles${ms ? `, ${duration(ms)}` : ""}</span>` : nothing}
      <span class="count" data-testid="timeline-index">${frames > 0 ? `${index + 1} / ${frames}` : `${frame?.seconds?.toFixed(2) ?? "0.00"} s`}</span>`;
  }
}
