// The densities of the surface and what a trim of some quantile cuts off them.
import type { Histogram } from "../engine/protocol";

/// Density below which a trim cuts, between the engine's pairs of quantile and density.
export function densityOf({ quantiles }: Histogram, quantile: number): number {
  let [q0, d0] = quantiles[0] ?? [0, 0];
  for (const [q, d] of quantiles) {
    if (quantile <= q) return q > q0 ? d0 + ((quantile - q0) / (q - q0)) * (d - d0) : d;
    [q0, d0] = [q, d];
  }
  return d0;
}

/// Where a density is along the bars, in [0, 1].
export function placeOf({ densities: { edges } }: Histogram, density: number): number {
  const bars = edges.length - 1;
  if (bars < 1) return 0;
  for (let i = 0; i < bars; ++i) {
    const [a, b] = [edges[i]!, edges[i + 1]!];
    if (density < b) return (i + Math.min(Math.max((density - a) / (b - a || 1), 0), 1)) / bars;
  }
  return 1;
}
