// What a tool held at each step of the history, so that undo brings its handles back with the surface.
export class Snapshots<T> {
  private readonly states = new Map<number, T>();
  private done = -1;

  /// A step is about to lead from `done` operations to one more.
  step(done: number, before: T, after: T): void {
    for (const key of [...this.states.keys()]) if (key > done) this.states.delete(key);
    this.states.set(done, before);
    this.states.set(done + 1, after);
  }

  /// The state to go back to when the history stands at `done`, if it has moved and one is known.
  arrive(done: number): T | null {
    if (done === this.done) return null;
    this.done = done;
    return this.states.get(done) ?? null;
  }

  clear(): void {
    this.states.clear();
  }
}
