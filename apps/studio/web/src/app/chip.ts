// What an operation did, in a line.
import type { StepRecord } from "../engine/protocol";
import { count, signed } from "../ui/format";

/// "+1,204 points, genus 3 → 1, components 2 → 1": only what changed.
export function chipText(record: StepRecord): string {
  const parts: string[] = [];
  if (record.added > 0) parts.push(`${signed(record.added)} points`);
  if (record.removed > 0) parts.push(`${signed(-record.removed)} points`);
  if (record.flipped) parts.push(`${count(record.flipped)} normals turned`);
  const { before, after } = record;
  if (before && after && before.genus !== after.genus) parts.push(`genus ${before.genus} → ${after.genus}`);
  if (before && after && before.components !== after.components) parts.push(`components ${before.components} → ${after.components}`);
  if (parts.length === 0 && !after) return "measuring the topology";
  return parts.length > 0 ? parts.join(", ") : "topology unchanged";
}
