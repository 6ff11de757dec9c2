// What tools draw over the view: every line twice, dark below bright, so that it is seen on any ground. Presentation
// attributes only, as the page's policy allows no inline styles.
import { type SVGTemplateResult, nothing, svg } from "lit";
import type { Pixel } from "../../engine/protocol";
import { linePath } from "./shapes";

export const kOrange = "var(--orange, #e8833a)";
export const kBlue = "var(--blue, #3f8fd2)";
export const kHalo = "rgb(12 14 18 / 60%)";
export const kLight = "#ffffff";

export interface LineStyle {
  colour?: string;
  width?: number;
  dashes?: boolean;
  moving?: boolean; // the dashes run along; never where motion is not wanted
  fill?: boolean;
  faint?: boolean;
  testid?: string;
}

/// A line or an area by its path data.
export function drawPath(d: string, style: LineStyle = {}): SVGTemplateResult {
  if (d === "") return svg``;
  const { colour = kOrange, width = 1.75 } = style;
  const run = svg`<animate attributeName="stroke-dashoffset" from="10" to="0" dur="0.6s" repeatCount="indefinite" />`;
  return svg`<g opacity=${style.faint ? 0.45 : 1} fill="none" stroke-linejoin="round" stroke-linecap="round">
    ${style.fill ? svg`<path d=${d} fill=${colour} fill-opacity="0.12" fill-rule="evenodd" />` : nothing}
    <path d=${d} stroke=${kHalo} stroke-width=${width + 2.25} />
    <path d=${d} stroke=${colour} stroke-width=${width} stroke-dasharray=${style.dashes ? "6 4" : "none"}
      data-testid=${style.testid ?? nothing}>${style.moving ? run : nothing}</path>
  </g>`;
}

export function drawLine(points: Pixel[], style: LineStyle = {}): SVGTemplateResult {
  return drawPath(linePath(points), style);
}

/// A round handle that can be dragged.
export function drawHandle([x, y]: Pixel, active = false, testid?: string, colour = kOrange): SVGTemplateResult {
  return svg`<circle cx=${x} cy=${y} r=${active ? 6 : 4.5} fill=${active ? colour : kLight} stroke=${active ? kLight : colour}
    stroke-width="1.75" data-testid=${testid ?? nothing} />`;
}

/// A ring in pixels, for radii and brushes.
export function drawRing([x, y]: Pixel, r: number, colour = kOrange, faint = false): SVGTemplateResult {
  return svg`<g fill="none" opacity=${faint ? 0.5 : 1}>
    <circle cx=${x} cy=${y} r=${r} stroke=${kHalo} stroke-width="3.5" />
    <circle cx=${x} cy=${y} r=${r} stroke=${colour} stroke-width="1.5" />
  </g>`;
}

/// Where the pointer is: a small cross, with a ring of `r` pixels where that says something.
export function drawCursor([x, y]: Pixel, r = 0): SVGTemplateResult {
  const cross = `M${x - 9} ${y}H${x - 3}M${x + 3} ${y}H${x + 9}M${x} ${y - 9}V${y - 3}M${x} ${y + 3}V${y + 9}`;
  return svg`<g data-testid="tool-cursor">
    ${r > 4 ? drawRing([x, y], r, kOrange, true) : nothing}
    ${drawPath(cross, { width: 1.25, colour: kLight })}
  </g>`;
}

/// A line of text with a dark edge.
export function drawLabel([x, y]: Pixel, text: string): SVGTemplateResult {
  return svg`<text x=${x} y=${y} font-size="11" fill=${kLight} stroke=${kHalo} stroke-width="3" paint-order="stroke"
    stroke-linejoin="round">${text}</text>`;
}
