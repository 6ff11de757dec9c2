// Reads a response whole into one buffer. With its length known, a BYOB reader fills the buffer without copies.

async function readInto(stream: ReadableStream<Uint8Array>, length: number): Promise<Uint8Array> {
  const reader = stream.getReader({ mode: "byob" });
  let buffer = new ArrayBuffer(length);
  let at = 0;
  while (at < length) {
    const { value, done } = await reader.read(new Uint8Array(buffer, at, length - at));
    if (value) {
      buffer = value.buffer as ArrayBuffer; // the one passed in was transferred
      at += value.byteLength;
    }
    if (done) throw new Error("the blob ended early");
  }
  reader.releaseLock();
  return new Uint8Array(buffer);
}

/// @throws Error unless the response is 200 and whole
export async function readAll(response: Response): Promise<Uint8Array> {
  if (!response.ok) throw new Error(`${response.status} for ${new URL(response.url).pathname}`);
  const length = Number(response.headers.get("Content-Length") ?? 0);
  const encoded = response.headers.has("Content-Encoding"); // then the length is that of the coded bytes
  if (length > 0 && !encoded && response.body) {
    try {
      return await readInto(response.body, length);
    } catch (error) {
      if (!(error instanceof TypeError)) throw error; // no byte stream here: below
    }
  }
  return new Uint8Array(await response.arrayBuffer());
}
