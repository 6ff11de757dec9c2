// Every command of the page with its key. Menus, keys and the palette come from this list.
import { tell } from "./context";
import type { StudioContext } from "./context";
import { currentTheme, rememberTheme } from "./theme";
import type { ColourMode, PanelId, ShowMode } from "../engine/store";
import type { Command } from "../ui/commands";
import { takePicture } from "./picture";

const kQuarter = Math.PI / 2;
const title = (text: string) => text.charAt(0).toUpperCase() + text.slice(1);

function edits({ connection, store, ...context }: StudioContext): Command[] {
  const ask = (verb: "undo" | "redo") => void connection.request(verb).catch((error) => tell(context, error));
  return [
    { id: "open", title: "Open…", key: "Ctrl+O", group: "File", run: () => context.openDialog("open") },
    { id: "save", title: "Save…", key: "Ctrl+S", group: "File", enabled: () => !!store.scene, run: () => context.openDialog("save") },
    { id: "undo", title: "Undo", key: "Ctrl+Z", group: "Edit", enabled: () => store.canUndo, run: () => ask("undo") },
    { id: "redo", title: "Redo", key: "Ctrl+Shift+Z", keys: ["Ctrl+Y"], group: "Edit", enabled: () => store.canRedo, run: () => ask("redo") },
  ];
}

/// Esc ends the nearest thing: what is being dragged, then the job.
function escape(context: StudioContext): Command {
  const { connection, store, live } = context;
  const run = () => {
    if (live.cancel() || store.progress) void connection.request("cancel").catch((error) => tell(context, error));
    else if (store.chip) store.update({ chip: null });
    else context.chooseTool("navigate");
  };
  return { id: "cancel", title: "Cancel what is running", key: "Escape", group: "Edit", run };
}

function axisViews({ viewport }: StudioContext): Command[] {
  const look = (azimuth: number, elevation: number) => {
    const goal = viewport.view.clone();
    Object.assign(goal, { azimuth, elevation });
    viewport.flyTo(goal);
  };
  const views: [string, string, number, number][] = [
    ["front", "1", 0, 0],
    ["back", "Ctrl+1", 2 * kQuarter, 0],
    ["right", "3", kQuarter, 0],
    ["left", "Ctrl+3", -kQuarter, 0],
    ["top", "7", 0, kQuarter],
    ["bottom", "Ctrl+7", 0, -kQuarter],
  ];
  return views.map(([name, key, azimuth, elevation]) => ({
    id: `view-${name}`,
    title: `View from the ${name}`,
    key,
    group: "View",
    run: () => look(azimuth, elevation),
  }));
}

function cameraCommands({ viewport, store }: StudioContext): Command[] {
  const projection = () => {
    viewport.view.orthographic = !viewport.view.orthographic;
    viewport.requestRender();
    store.update();
  };
  const up = () => {
    viewport.view.up = viewport.view.up === "y" ? "z" : "y";
    viewport.apply(store.view);
    viewport.frame();
    store.update();
  };
  return [
    { id: "frame", title: "Frame all", key: "F", keys: ["Home"], group: "View", run: () => viewport.frame() },
    { id: "projection", title: "Perspective or orthographic", key: "5", group: "View", run: projection },
    { id: "up-axis", title: "Up axis: Y or Z", group: "View", run: up },
  ];
}

function showCommands({ store, link }: StudioContext): Command[] {
  const shows: [ShowMode, string][] = [
    ["points", "Shift+1"],
    ["mesh", "Shift+2"],
    ["both", "Shift+3"],
  ];
  const colours: ColourMode[] = ["plain", "colour", "density", "confidence", "weakness", "distance"];
  const has = (colour: ColourMode) => !!store.mesh && (colour !== "colour" || store.meshAttributes.includes(colour));
  return [
    ...shows.map(([show, key]) => ({ id: `show-${show}`, title: `Show ${show}`, key, group: "View", run: () => store.setView({ show }) })),
    { id: "hide", title: "Hide or show points and surface", key: "H", group: "View", run: () => store.setView({ hidden: !store.view.hidden }) },
    { id: "wireframe", title: "Wireframe", key: "Shift+W", group: "View", run: () => store.setView({ wireframe: !store.view.wireframe }) },
    { id: "grid", title: "Ground grid", key: "Shift+G", group: "View", run: () => store.setView({ grid: !store.view.grid }) },
    ...colours.map((colour) => ({
      id: `colour-${colour}`,
      title: colour === "plain" ? "Colour the surface plainly" : `Colour the surface by ${colour}`,
      group: "View",
      enabled: () => has(colour),
      run: () => void link.colour(colour),
    })),
  ];
}

function pageCommands(context: StudioContext): Command[] {
  const panels: PanelId[] = ["reconstruct", "points", "surface", "problems", "history"];
  const theme = () => {
    const next = currentTheme() === "dark" ? "light" : "dark";
    rememberTheme(next);
    context.setTheme(next);
    context.store.update();
  };
  return [
    ...panels.map((panel, i) => ({
      id: `panel-${panel}`,
      title: `Panel: ${title(panel)}`,
      key: `Alt+${i + 1}`,
      group: "Page",
      run: () => context.store.update({ panel }),
    })),
    { id: "picture", title: "Picture of the view…", group: "File", run: () => void takePicture(context) },
    { id: "compare", title: "Compare with a reference…", group: "Surface", enabled: () => !!context.store.mesh, run: () => context.openDialog("reference") },
    { id: "theme", title: "Dark or light", key: "Ctrl+Alt+T", group: "Page", run: theme },
    { id: "palette", title: "All commands…", key: "Ctrl+K", keys: ["Ctrl+Shift+P", "F1"], group: "Page", run: () => context.openPalette() },
    { id: "keys", title: "Keys…", key: "?", group: "Page", run: () => context.openDialog("keys") },
  ];
}

export function addCommands(context: StudioContext): void {
  const { commands, tools } = context;
  commands.add(...edits(context), escape(context), ...cameraCommands(context), ...axisViews(context));
  commands.add(...showCommands(context), ...pageCommands(context));
  for (const tool of tools) {
    commands.add({
      id: `tool-${tool.id}`,
      title: `Tool: ${tool.title}`,
      key: tool.key.toUpperCase(),
      group: "Tools",
      run: () => context.chooseTool(tool.id),
    });
  }
}
