// Pictures of the page's own buttons: paths on 24 x 24, stroked.
import { html, svg } from "lit";
import type { TemplateResult } from "lit";

export const icons = {
  open: "M3 6a2 2 0 012-2h4l2 3h8a2 2 0 012 2v9a2 2 0 01-2 2H5a2 2 0 01-2-2z",
  save: "M5 3h11l3 3v15H5zM8 3v6h7V3M8 21v-7h8v7",
  undo: "M9 6L4 11l5 5M4 11h10a6 6 0 010 12h-1",
  redo: "M15 6l5 5-5 5M20 11H10a6 6 0 000 12h1",
  points: "M6 7h.01M12 5h.01M18 8h.01M5 13h.01M11 12h.01M17 14h.01M8 19h.01M14 19h.01",
  mesh: "M4 17L9 5l11 5-4 9zM9 5l7 14M4 17l16-7",
  both: "M4 19L9 10l11 2-4 7zM6 5h.01M12 4h.01M18 6h.01M4 11h.01",
  wire: "M3 7l9-4 9 4v10l-9 4-9-4zM3 7l9 4 9-4M12 11v10",
  frame: "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5M9 12h6M12 9v6",
  camera: "M4 8h3l2-3h6l2 3h3v11H4zM12 16.5a3.5 3.5 0 100-7 3.5 3.5 0 000 7z",
  sun: "M12 8a4 4 0 100 8 4 4 0 000-8zM12 2v2M12 20v2M4.9 4.9l1.4 1.4M17.7 17.7l1.4 1.4M2 12h2M20 12h2M4.9 19.1l1.4-1.4M17.7 6.3l1.4-1.4",
  moon: "M20 14A8.5 8.5 0 1110 4a7 7 0 0010 10z",
  search: "M11 4a7 7 0 100 14 7 7 0 000-14zM16 16l5 5",
  close: "M6 6l12 12M18 6L6 18",
  up: "M12 19V5M6 11l6-6 6 6",
  folder: "M3 7a2 2 0 012-2h4l2 2h8a2 2 0 012 2v8a2 2 0 01-2 2H5a2 2 0 01-2-2z",
  file: "M6 3h8l4 4v14H6zM14 3v4h4",
  play: "M7 4l13 8-13 8z",
  pause: "M7 5v14M17 5v14",
  next: "M5 4l10 8-10 8zM19 5v14",
  previous: "M19 4L9 12l10 8zM5 5v14",
  loop: "M17 2l4 4-4 4M3 11V9a3 3 0 013-3h15M7 22l-4-4 4-4M21 13v2a3 3 0 01-3 3H3",
  cut: "M3 8l9-5 9 5-9 5zM3 16l9 5 9-5M7.5 10.5L3 13M16.5 10.5L21 13",
  grid: "M4 4h16v16H4zM4 9.3h16M4 14.6h16M9.3 4v16M14.6 4v16",
} as const;

export function glyph(path: string): TemplateResult {
  return html`<svg class="glyph" viewBox="0 0 24 24" aria-hidden="true">${svg`<path d=${path}></path>`}</svg>`;
}
