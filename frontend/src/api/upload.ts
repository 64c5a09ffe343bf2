/** Sends a file as it is, with progress. `fetch` tells nothing about what was sent, so this is an XMLHttpRequest. */

import { text } from "../strings";
import { errorFromBody } from "./client";
import type { Drive } from "./types";

export interface Upload {
  done: Promise<Drive>;
  cancel: () => void;
}

export function uploadDrive(file: File, onProgress: (loaded: number, total: number) => void): Upload {
  const request = new XMLHttpRequest();
  const done = new Promise<Drive>((resolve, reject) => {
    request.upload.onprogress = (event) => onProgress(event.loaded, event.total || file.size);
    request.onload = () => {
      const body: unknown = request.response;
      if (request.status >= 200 && request.status < 300) resolve(body as Drive);
      else reject(errorFromBody(request.status, body));
    };
    request.onerror = () => reject(new Error(text.drives.uploadBroken));
    request.onabort = () => reject(new DOMException("cancelled", "AbortError"));
    request.open("POST", `/api/drives/upload?filename=${encodeURIComponent(file.name)}`);
    request.setRequestHeader("Content-Type", "application/octet-stream");
    request.responseType = "json";
    request.send(file);
  });
  return { done, cancel: () => request.abort() };
}
