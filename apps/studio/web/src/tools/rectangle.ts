// A rectangle is filled in volume.
import { RectangleGesture } from "./shared/gestures";
import { GuideTool } from "./shared/guide_tool";
import { register } from "./registry";

export const rectangle = register((context) =>
  new GuideTool(context, new RectangleGesture(), {
    id: "rectangle",
    title: "Guide by a rectangle",
    key: "r",
    icon: "M4 6h16v12H4zM4 6h.01M20 6h.01M4 18h.01M20 18h.01",
    hint: "Drag a rectangle to fill it with points; [ ] interval, Enter adds, Esc drops",
  }));
