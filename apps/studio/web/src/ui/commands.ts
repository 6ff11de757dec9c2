// All that can be done, by name: the palette, the keys and the menus all come from here.

export interface Command {
  id: string;
  title: string;
  key?: string; // as people read it: "Ctrl+Shift+Z", "F", "Space"
  keys?: string[]; // further ones
  group?: string;
  run(): void;
  enabled?(): boolean;
}

/// "ctrl+shift+z" of an event or of a written key, so that both compare. Command counts as Ctrl.
export function normaliseKey(key: string): string {
  const parts = key.toLowerCase().split("+");
  const last = parts.pop() || "+";
  const held = ["ctrl", "alt", "shift"].filter((name) => parts.includes(name));
  return [...held, last].join("+");
}

export function keyOf(event: Pick<KeyboardEvent, "key" | "code" | "ctrlKey" | "metaKey" | "altKey" | "shiftKey">): string {
  const digit = /^(?:Digit|Numpad)(\d)$/.exec(event.code)?.[1]; // so that Shift and the layout do not matter
  const key = digit ?? (event.key === " " ? "space" : event.key.toLowerCase());
  const held = [event.ctrlKey || event.metaKey ? "ctrl" : "", event.altKey ? "alt" : ""];
  // Shift is part of what was typed for signs such as "?" and "[".
  const letter = /^[a-z]$/.test(key) || key.length > 1 || digit !== undefined;
  if (event.shiftKey && letter) held.push("shift");
  return [...held.filter(Boolean), key].join("+");
}

/// How well a query fits a title: > 0 fits, more is better. Letters must come in order; starts of words count most.
export function score(query: string, title: string): number {
  const [q, t] = [query.trim().toLowerCase(), title.toLowerCase()];
  if (q === "") return 1;
  const whole = t.indexOf(q);
  if (whole >= 0) {
    const begins = whole === 0 || t[whole - 1] === " " ? 500 : 0;
    const ends = /^(\W|$)/.test(t.slice(whole + q.length)) ? 100 : 0;
    return 1000 - whole + begins + ends - t.length / 100;
  }
  let [at, sum] = [0, 0];
  for (const letter of q) {
    if (letter === " ") continue;
    const found = t.indexOf(letter, at);
    if (found < 0) return 0;
    sum += found === 0 || t[found - 1] === " " ? 12 : found === at ? 6 : 1;
    at = found + 1;
  }
  return sum - t.length / 100 > 0 ? sum - t.length / 100 : 0.01;
}

export class Commands {
  private readonly all = new Map<string, Command>();

  add(...commands: Command[]): void {
    for (const command of commands) this.all.set(command.id, command);
  }

  get(id: string): Command | undefined {
    return this.all.get(id);
  }

  /// @returns false if there is no such command or it cannot be done now
  run(id: string): boolean {
    const command = this.all.get(id);
    if (!command || command.enabled?.() === false) return false;
    command.run();
    return true;
  }

  byKey(event: KeyboardEvent): Command | undefined {
    const key = keyOf(event);
    const fits = (written: string) => normaliseKey(written) === key;
    return [...this.all.values()].find((c) => [c.key ?? "", ...(c.keys ?? [])].some((k) => k !== "" && fits(k)));
  }

  /// Those that fit a query, the best first; the order of adding among equals.
  search(query: string): Command[] {
    const scored = [...this.all.values()].map((command) => ({ command, value: score(query, command.title) }));
    return scored.filter((s) => s.value > 0).sort((a, b) => b.value - a.value).map((s) => s.command);
  }
}
