// Opening files, by whichever way they come: below the root, dropped, or generated.
import { upload } from "../engine/session";
import type { FilePlace } from "../engine/protocol";
import { bytes } from "../ui/format";
import { tell } from "./context";
import type { StudioContext } from "./context";

export async function openPlaces(context: StudioContext, files: FilePlace[], add: boolean): Promise<boolean> {
  try {
    await context.connection.request("open", { files, add });
    return true;
  } catch (error) {
    tell(context, error);
    return false;
  }
}

export async function resume(context: StudioContext, path: string): Promise<boolean> {
  try {
    await context.connection.request("resume", { path });
    return true;
  } catch (error) {
    tell(context, error);
    return false;
  }
}

/// Uploads files one after another. @returns their places, null if one failed or is larger than the server takes
export async function uploadAll(context: StudioContext, files: File[], progress: (fraction: number, name: string) => void): Promise<FilePlace[] | null> {
  const limit = context.store.hello?.max_upload ?? Infinity;
  const total = files.reduce((sum, file) => sum + file.size, 0) || 1;
  let before = 0;
  const places: FilePlace[] = [];
  for (const file of files) {
    if (file.size > limit) {
      context.notice("error", `${file.name} has ${bytes(file.size)}, and the server takes ${bytes(limit)} (--max-upload)`);
      return null;
    }
    try {
      const sent = await upload(file, file.name, (share) => progress((before + share * file.size) / total, file.name));
      places.push({ upload: sent.upload });
    } catch (error) {
      context.notice("error", `${file.name}: ${(error as Error).message}`);
      return null;
    }
    before += file.size;
  }
  return places;
}

export async function openDropped(context: StudioContext, files: File[], progress: (fraction: number, name: string) => void): Promise<void> {
  const places = await uploadAll(context, files, progress);
  if (places?.length) await openPlaces(context, places, false);
}

/// Asks for files of this computer.
export function chooseFiles(multiple: boolean): Promise<File[]> {
  const input = document.createElement("input");
  input.type = "file";
  input.multiple = multiple;
  return new Promise((resolve) => {
    input.onchange = () => resolve([...(input.files ?? [])]);
    input.oncancel = () => resolve([]);
    input.click();
  });
}
