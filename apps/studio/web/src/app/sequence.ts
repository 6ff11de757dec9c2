// Sequences of files: playing, stepping, looping. Frames that come too late are dropped by the engine, so that playing
// asks for the next one when the last is on the screen, and never queues.
import type { SequenceState } from "../engine/store";
import { tell } from "./context";
import type { StudioContext } from "./context";

export async function startSequence(context: StudioContext, path: string): Promise<void> {
  const { connection, store } = context;
  try {
    const { frames, name } = await connection.request("sequence", { path });
    store.update({
      sequence: { kind: "files", name, frames, index: 0, playing: false, loop: true, cached: new Set(), frame: null },
    });
    await connection.request("frame", { index: 0 });
  } catch (error) {
    tell(context, error);
  }
}

/// The frame after this one, or null at the end without a loop.
export function nextFrame({ index, frames, loop }: Pick<SequenceState, "index" | "frames" | "loop">): number | null {
  if (index + 1 < frames) return index + 1;
  return loop && frames > 1 ? 0 : null;
}

export class Player {
  private asking = false;

  constructor(private readonly context: StudioContext) {}

  show(index: number): void {
    const { store } = this.context;
    const { sequence } = store;
    if (!sequence) return;
    const inside = sequence.frames > 0 ? Math.min(Math.max(index, 0), sequence.frames - 1) : index;
    store.update({ sequence: { ...sequence, index: inside } });
    void this.ask(inside);
  }

  /// The engine drops a frame while two are not drawn yet; the one that the hand rests on is asked for again.
  private async ask(index: number): Promise<void> {
    const { connection, store } = this.context;
    try {
      const { shown } = await connection.request("frame", { index });
      if (!shown && store.sequence?.index === index && !store.sequence.playing) setTimeout(() => void this.ask(index), 60);
    } catch (error) {
      tell(this.context, error);
    }
  }

  toggle(): void {
    const { connection, store } = this.context;
    const { sequence } = store;
    if (!sequence) return;
    const playing = !sequence.playing;
    store.update({ sequence: { ...sequence, playing } });
    if (sequence.kind === "fluid") connection.request("fluid", { pause: !playing }).catch((error) => tell(this.context, error));
    else if (playing) void this.play();
  }

  private async play(): Promise<void> {
    if (this.asking) return;
    this.asking = true;
    for (;;) {
      const { sequence } = this.context.store;
      const next = sequence?.playing ? nextFrame(sequence) : null;
      if (!sequence || next === null) break;
      const begun = performance.now();
      try {
        await this.context.connection.request("frame", { index: next });
      } catch (error) {
        tell(this.context, error);
        break;
      }
      const now = this.context.store.sequence;
      if (!now?.playing) break;
      this.context.store.update({ sequence: { ...now, index: next } });
      await new Promise((resolve) => setTimeout(resolve, Math.max(1000 / 25 - (performance.now() - begun), 0)));
    }
    this.asking = false;
    const { sequence } = this.context.store;
    if (sequence?.kind === "files" && sequence.playing) this.context.store.update({ sequence: { ...sequence, playing: false } });
  }

  stop(): void {
    const { connection, store } = this.context;
    const kind = store.sequence?.kind;
    store.update({ sequence: null });
    connection
      .request(kind === "fluid" ? "fluid" : "sequence", { stop: true })
      .then(() => store.scene && connection.request("reference_end")) // the scene's own surface is shown again
      .catch((error) => tell(this.context, error));
  }
}
