// Where the points of a preview are: asked of what is on the screen, as the engine sends no box with them.
import type * as THREE from "three";
import type { Box, Vec3 } from "../../engine/protocol";
import { unionOf } from "./interval";

/// Box of all objects of a layer. Each holds positions from 0 to 1, which its own scale and position put into the world.
export function boxOfLayer(group: Pick<THREE.Group, "children">): Box | null {
  const boxes = group.children.map((object): Box => {
    const lower = object.position.toArray() as Vec3;
    return { lower, upper: lower.map((l, a) => l + object.scale.toArray()[a]!) as Vec3 };
  });
  return unionOf(boxes);
}
