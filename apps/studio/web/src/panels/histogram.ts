// The densities of the surface and what a trim of some quantile cuts off them.
import type { Histogram } from "../engine/protocol";

/// Density below which the share `quantile` lies: from the engine's pairs where it sent them, else from the counts.
export function densityOf(histogram: Histogram, quantile: number): number {
  const { edges } = histogram.densities;
  const first = edges[0] ?? 0;
  if (quantile <= 0) return first;
  const pairs = histogram.quantiles?.length ? histogram.quantiles : cumulated(histogram);
  let [q0, d0] = [0, first];
  for (const [q, d] of pairs) {
    if (quantile <= q) return q > q0 ? d0 + ((quantile - q0) / (q - q0)) * (d - d0) : d;
    [q0, d0] = [q, d];
  }
  return d0;
}

function cumulated(histogram: Histogram): [number, number][] {
  const { edges, counts } = histogram.densities;
  const sum = counts.reduce((total, value) => total + value, 0) || 1;
  let running = 0;
  return counts.map((value, i) => {
    running += value;
    return [running / sum, edges[i + 1] ?? edges[edges.length - 1] ?? 0];
  });
}

/// Where a density is along the bars, in [0, 1].
export function placeOf(histogram: Histogram, density: number): number {
  const { edges } = histogram.densities;
  const bars = edges.length - 1;
  if (bars < 1) return 0;
  for (let i = 0; i < bars; ++i) {
    const [a, b] = [edges[i]!, edges[i + 1]!];
    if (density < b) return (i + Math.min(Math.max((density - a) / (b - a || 1), 0), 1)) / bars;
  }
  return 1;
}
