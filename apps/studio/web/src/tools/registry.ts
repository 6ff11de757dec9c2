// The tools of the page, in the order in which index.ts names their files.
import type { ToolFactory } from "./tool";

export const tools: ToolFactory[] = [];

/// Called once by the file of each tool.
export function register(factory: ToolFactory): ToolFactory {
  tools.push(factory);
  return factory;
}
