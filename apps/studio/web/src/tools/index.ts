// The tools in the order of the tool bar; one line a tool.
import { navigate } from "./navigate";
import type { ToolFactory } from "./tool";

export const tools: ToolFactory[] = [navigate];
