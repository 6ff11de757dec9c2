// Corners set by clicks enclose what is filled.
import { PolygonGesture } from "./shared/gestures";
import { GuideTool } from "./shared/guide_tool";
import { register } from "./registry";

export const polygon = register((context) =>
  new GuideTool(context, new PolygonGesture(), {
    id: "polygon",
    title: "Guide by a polygon",
    key: "p",
    icon: "M5 9l8-5 7 7-5 9-9-2z",
    hint: "Click corners, Backspace takes one back; Enter closes, then adds, Esc drops",
  }));
