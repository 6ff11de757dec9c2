// An area whose shape is chosen in the settings, for tools that take points out or turn them round.
import type { TemplateResult } from "lit";
import type { Layers } from "../../engine/protocol";
import { segmentsRow } from "../../ui/controls";
import type { ToolContext } from "../tool";
import { type Gesture, LassoGesture, PolygonGesture, RectangleGesture } from "./gestures";
import { ShapeTool } from "./shape_tool";

export type AreaShape = "rectangle" | "lasso" | "polygon";

export function gestureOf(shape: AreaShape): Gesture {
  return shape === "rectangle" ? new RectangleGesture() : shape === "lasso" ? new LassoGesture() : new PolygonGesture();
}

export function shapeRow(testid: string, value: AreaShape, change: (value: AreaShape) => void): TemplateResult {
  return segmentsRow({
    label: "Shape",
    testid,
    value,
    choices: [
      { value: "rectangle", label: "Box", title: "Drag a rectangle" },
      { value: "lasso", label: "Lasso", title: "Draw a loop; hold Alt for further ones" },
      { value: "polygon", label: "Polygon", title: "Click corners; Enter or a click on the first closes" },
    ],
    change,
  });
}

export abstract class AreaTool extends ShapeTool {
  protected shapeKind: AreaShape = "rectangle";
  protected layers: Layers = "through";

  constructor(context: ToolContext) {
    super(context, gestureOf("rectangle"));
  }

  protected setShape(shape: AreaShape): void {
    this.drop();
    this.shapeKind = shape;
    this.gesture = gestureOf(shape);
    this.context.redraw();
  }

  /// The settings have changed: what they do to the present shape is asked for again.
  protected changed(): void {
    this.preview();
    this.context.redraw();
  }

  protected shapeRow(): TemplateResult {
    return shapeRow(`${this.id}-shape`, this.shapeKind, (shape) => this.setShape(shape));
  }

  protected layersRow(): TemplateResult {
    return segmentsRow<Layers>({
      label: "Depth",
      testid: `${this.id}-layers`,
      value: this.layers,
      choices: [
        { value: "through", label: "Through", title: "All points behind the area" },
        { value: "front", label: "Front layer", title: "Only what the present surface does not hide" },
      ],
      change: (layers) => {
        this.layers = layers;
        this.changed();
      },
    });
  }
}
