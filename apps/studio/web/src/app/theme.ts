// Dark and light: the page's variables, and the same colours in the view.
import type { Viewport } from "../view/viewport";

export type Theme = "dark" | "light";
const kKey = "pointskin-theme";

/// What was chosen last, else what the system says.
export function chosenTheme(): Theme {
  const stored = localStorage.getItem(kKey);
  if (stored === "dark" || stored === "light") return stored;
  return matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
}

export function currentTheme(): Theme {
  return document.documentElement.dataset["theme"] === "light" ? "light" : "dark";
}

export function variable(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

export function paintTheme(theme: Theme, viewport: Viewport): void {
  document.documentElement.dataset["theme"] = theme;
  viewport.setTheme({
    clay: variable("--clay"),
    back: variable("--clay-back"),
    points: variable("--points"),
    grid: variable("--grid"),
  });
}

export function rememberTheme(theme: Theme): void {
  localStorage.setItem(kKey, theme);
}
