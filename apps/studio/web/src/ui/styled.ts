// Styles of single elements, set through the CSSOM: the style attribute is not allowed by the content security policy,
// and lit's own styleMap writes it when it first renders.
import { noChange } from "lit";
import { Directive, PartType, directive } from "lit/directive.js";
import type { ElementPart, PartInfo } from "lit/directive.js";

class Styled extends Directive {
  private readonly before = new Map<string, string>();

  constructor(part: PartInfo) {
    super(part);
    if (part.type !== PartType.ELEMENT) throw new Error("styled() belongs into the tag, not into an attribute");
  }

  render(_styles: Record<string, string>) {
    return noChange;
  }

  override update(part: ElementPart, [styles]: [Record<string, string>]) {
    const { style } = part.element as HTMLElement;
    for (const [name, value] of Object.entries(styles)) {
      if (this.before.get(name) === value) continue;
      style.setProperty(name, value);
      this.before.set(name, value);
    }
    return noChange;
  }
}

/// In a tag: `<div ${styled({ width: "40%" })}>`. Names as in CSS.
export const styled = directive(Styled);
