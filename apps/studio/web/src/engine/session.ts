// The token of the opened address becomes a cookie; it is then taken out of the address, so that it is in no history,
// picture or copied link.

export type Admission = "admitted" | "refused" | "unreachable";

export async function exchangeToken(): Promise<Admission> {
  const token = location.hash.slice(1);
  try {
    if (token) {
      const answer = await fetch("/session", { method: "POST", body: token, credentials: "same-origin" });
      history.replaceState(null, "", location.pathname + location.search);
      if (!answer.ok) return "refused";
      return "admitted";
    }
    return await admission();
  } catch {
    return "unreachable";
  }
}

/// Whether the cookie that this page has is still good.
export async function admission(): Promise<Admission> {
  try {
    const probe = await fetch("/blob/0", { credentials: "same-origin" });
    return probe.status === 401 ? "refused" : "admitted";
  } catch {
    return "unreachable";
  }
}

export function socketAddress(): string {
  return `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket`;
}

/// Sends a file as the body of a request, with progress; the server streams it to a temporary file.
export function upload(file: Blob, name: string, progress: (fraction: number) => void): Promise<{ upload: number; bytes: number }> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest(); // fetch does not tell how much was sent
    request.open("POST", `/upload?name=${encodeURIComponent(name)}`);
    request.responseType = "text";
    request.upload.onprogress = (event) => progress(event.lengthComputable ? event.loaded / event.total : 0);
    request.onerror = () => reject(new Error("the upload was cut off"));
    request.onload = () => {
      if (request.status === 200) resolve(JSON.parse(request.responseText) as { upload: number; bytes: number });
      else if (request.status === 413) reject(new Error("the file is larger than the server takes (--max-upload)"));
      else reject(new Error(`the server answered ${request.status}`));
    };
    request.send(file);
  });
}
