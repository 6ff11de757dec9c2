// The view as a PNG, downloaded by the browser or uploaded for the server to write below its root.
import { upload } from "../engine/session";
import { variable } from "./theme";
import { tell } from "./context";
import type { StudioContext } from "./context";
import { bytes } from "../ui/format";

export function pictureOf(context: StudioContext): Promise<Blob> {
  return context.viewport.picture(variable("--ground-top"), variable("--ground-bottom"));
}

/// Hands a file to the browser's own saving.
export function handOver(address: string, name: string): void {
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
}

export async function takePicture(context: StudioContext, name = "picture.png"): Promise<void> {
  try {
    const blob = await pictureOf(context);
    const address = URL.createObjectURL(blob);
    handOver(address, name);
    setTimeout(() => URL.revokeObjectURL(address), 10_000);
    context.notice("info", `Saved ${name}, ${bytes(blob.size)}`);
  } catch (error) {
    tell(context, error);
  }
}

export async function savePicture(context: StudioContext, name: string, folder: string, overwrite: boolean) {
  const sent = await upload(await pictureOf(context), name, () => undefined);
  return context.connection.request("save", { what: "picture", upload: sent.upload, name, folder, overwrite });
}
