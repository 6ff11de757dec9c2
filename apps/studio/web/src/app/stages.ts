// The stages from points to pixels, in their order.
import type { StageTimes } from "../engine/protocol";

export const kStages = ["simulate", "surface", "octree", "splat", "solve", "extract", "encode", "transfer", "decode", "draw"] as const;

/// The stages that took any time, with their share of the sum.
export function stageShares(ms: StageTimes): { stage: string; ms: number; share: number }[] {
  const known = kStages.flatMap((stage) => (ms[stage] ? [{ stage, ms: ms[stage] }] : []));
  const sum = known.reduce((total, { ms: value }) => total + value, 0);
  return known.map((entry) => ({ ...entry, share: entry.ms / sum }));
}
