// What modules of the page need of a browser to be loaded by node: a registry of elements that does nothing.
const page = globalThis as { customElements?: unknown; HTMLElement?: unknown };
page.customElements ??= { define: () => undefined, get: () => undefined };
page.HTMLElement ??= class {};
export {};
