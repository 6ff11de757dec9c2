// Loops drawn by hand are filled in volume; a loop inside another is a hole.
import { LassoGesture } from "./shared/gestures";
import { GuideTool } from "./shared/guide_tool";
import { register } from "./registry";

export const lasso = register((context) =>
  new GuideTool(context, new LassoGesture(), {
    id: "lasso",
    title: "Guide by a lasso",
    key: "l",
    icon: "M12 4c5 0 9 2.5 9 6s-4 6-9 6-9-2.5-9-6 4-6 9-6zM6 15c-1 2 0 3 2 3s2 2 0 3",
    hint: "Draw a loop to fill it; Alt or Shift adds loops and holes, Enter adds, Esc drops",
  }));
