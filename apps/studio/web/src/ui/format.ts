// Numbers, sizes and times as people read them. Locale-independent, so that pages look the same everywhere.

/// 1204 -> "1,204".
export function count(value: number): string {
  if (!Number.isFinite(value)) return "–";
  return String(Math.round(value)).replace(/\B(?=(\d{3})+(?!\d))/g, ",");
}

/// 1204 -> "1.2 k", for narrow places.
export function shortCount(value: number): string {
  const units = ["", " k", " M", " G"];
  let [v, u] = [Math.abs(value), 0];
  while (v >= 999.5 && u < 3) [v, u] = [v / 1000, u + 1];
  const text = u === 0 ? String(Math.round(v)) : v < 10 ? v.toFixed(1) : v.toFixed(0);
  return (value < 0 ? "−" : "") + text + units[u]!;
}

export function bytes(value: number): string {
  const units = ["bytes", "KB", "MB", "GB", "TB"];
  let [v, u] = [value, 0];
  while (v >= 1000 && u < 4) [v, u] = [v / 1000, u + 1];
  return `${u === 0 ? count(v) : v < 10 ? v.toFixed(1) : v.toFixed(0)} ${units[u]}`;
}

/// Milliseconds: "0.4 ms", "38 ms", "1.2 s", "2 min 5 s".
export function duration(ms: number): string {
  if (!Number.isFinite(ms)) return "–";
  if (ms < 10) return `${ms.toFixed(1)} ms`;
  if (ms < 999.5) return `${Math.round(ms)} ms`;
  if (ms < 59_950) return `${(ms / 1000).toFixed(1)} s`;
  const seconds = Math.round(ms / 1000);
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ${seconds % 60} s`;
  return `${Math.floor(seconds / 3600)} h ${Math.floor((seconds % 3600) / 60)} min`;
}

/// Four significant digits, with a power of ten where zeros would be many.
export function measure(value: number): string {
  if (value === 0) return "0";
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-4) return value.toExponential(2).replace("e+", "e");
  if (size >= 1000) return value.toFixed(1);
  return String(Number(value.toPrecision(4)));
}

/// "+1,204" or "−12"; U+2212, which has the width of the plus.
export function signed(value: number): string {
  return value < 0 ? `−${count(-value)}` : `+${count(value)}`;
}

export function percent(share: number): string {
  return `${(100 * share).toFixed(share < 0.1 && share > 0 ? 1 : 0)} %`;
}
