// Navigation alone: takes no event, so that every one moves the view.
import { register } from "./registry";

export const navigate = register(() => ({
  id: "navigate",
  title: "Navigate",
  key: "v",
  icon: "M5 3l14 8-6 2-3 6z",
  hint: "Drag turns, Shift+drag moves, wheel goes nearer, double click sets the centre",
}));
