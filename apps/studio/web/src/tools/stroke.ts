// A stroke is extruded along the view: a membrane of points.
import { StrokeGesture } from "./shared/gestures";
import { GuideTool } from "./shared/guide_tool";
import { register } from "./registry";

export const stroke = register((context) =>
  new GuideTool(context, new StrokeGesture(), {
    id: "stroke",
    title: "Guide by a stroke",
    key: "b",
    icon: "M4 20c4-1 3-6 7-7s5-1 9-9M4 20l1-4M4 20l4-1",
    hint: "Drag a membrane of points along the view; [ ] interval, Enter adds, Esc drops",
  }));
