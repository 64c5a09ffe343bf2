/** Uploads that run, and how they ended. They go on while the person looks at another page. */

import { create } from "zustand";
import { messageOf } from "../api/client";
import { queryClient } from "../api/queries";
import { uploadDrive } from "../api/upload";

export interface RunningUpload {
  id: number;
  fileName: string;
  loaded: number;
  total: number;
  startedAtMs: number;
  state: "sending" | "unpacking" | "failed";
  error: string | null;
  cancel: () => void;
}

interface Uploads {
  list: RunningUpload[];
  start: (file: File) => void;
  dismiss: (id: number) => void;
}

let lastId = 0;

export const useUploads = create<Uploads>()((set) => {
  const change = (id: number, to: Partial<RunningUpload>) =>
    set(({ list }) => ({ list: list.map((one) => (one.id === id ? { ...one, ...to } : one)) }));
  const dismiss = (id: number) => set(({ list }) => ({ list: list.filter((one) => one.id !== id) }));
  return {
    list: [],
    dismiss,
    start: (file) => {
      lastId += 1;
      const id = lastId;
      const upload = uploadDrive(file, (loaded, total) =>
        change(id, { loaded, total, state: loaded >= total ? "unpacking" : "sending" }),
      );
      const entry: RunningUpload = {
        id,
        fileName: file.name,
        loaded: 0,
        total: file.size,
        startedAtMs: performance.now(),
        state: "sending",
        error: null,
        cancel: upload.cancel,
      };
      set(({ list }) => ({ list: [...list, entry] }));
      upload.done.then(
        async () => {
          await queryClient.invalidateQueries({ queryKey: ["drives"] });
          dismiss(id);
        },
        (cause: unknown) => {
          if (cause instanceof DOMException) dismiss(id);
          else change(id, { state: "failed", error: messageOf(cause) });
        },
      );
    },
  };
});
