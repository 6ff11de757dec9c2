// Names of folders and files as the server has them: absolute, with slashes.

export function joined(folder: string, name: string): string {
  if (name === "" || folder === "") return folder + name;
  return `${folder.replace(/\/$/, "")}/${name}`;
}

/// The folder above; null where that is outside of every root.
export function parentOf(folder: string, roots: string[]): string | null {
  const plain = folder.replace(/\/$/, "");
  const above = plain.slice(0, Math.max(plain.lastIndexOf("/"), 1));
  const inside = (root: string) => above === root || above.startsWith(root.endsWith("/") ? root : `${root}/`);
  return plain !== above && roots.some(inside) ? above : null;
}

/// The name with this extension instead of its own.
export function withExtension(name: string, extension: string): string {
  const stem = name.replace(/\.[A-Za-z0-9]{1,5}$/, "");
  return `${stem || "scene"}.${extension.replace(/^\./, "")}`;
}
