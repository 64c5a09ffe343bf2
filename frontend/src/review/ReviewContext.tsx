/** What all parts of one review page share: the drive, its frames, and what the person does. */

import { useQueryClient } from "@tanstack/react-query";
import { createContext, type ReactNode, useContext, useEffect, useState, useSyncExternalStore } from "react";
import { useStore } from "zustand";
import { api, unwrap } from "../api/client";
import type { DriveDetail } from "../api/types";
import { firstWidths } from "./cameras/firstWidths";
import { type CommittedFrame, FrameStore } from "./cameras/frameStore";
import { type ObservationPage, ObservationStore } from "./cameras/observationStore";
import { CropStore, loadPicture } from "./cameras/pictures";
import { createViewStore, type ViewStore } from "./cameras/viewStore";
import { createReviewStore, type ReviewState, type ReviewStore } from "./reviewStore";
import { readUrl, writeUrl } from "./urlState";

const URL_DELAY_MS = 200;

interface Shared {
  driveId: number;
  store: ReviewStore;
  frames: FrameStore<ImageBitmap>;
  observations: ObservationStore;
  crops: CropStore;
  /** Pan and zoom of each camera. */
  views: ViewStore;
  /** Widths to ask pictures for, by camera; undefined is the original. Set by the camera grid. */
  pictureWidths: Map<string, number | undefined>;
}

const SharedContext = createContext<(Shared & { drive: DriveDetail }) | null>(null);

function share(drive: DriveDetail, onNewRevision: () => void): Shared {
  const store = createReviewStore(readUrl(window.location.search), drive.frame_count);
  const pictureWidths = new Map<string, number | undefined>();
  const observations = new ObservationStore(
    async (start, stop) => {
      const path = { drive_id: drive.id };
      const page = await unwrap(
        api.GET("/api/drives/{drive_id}/observations", { params: { path, query: { start, stop } } }),
      );
      // openapi-fetch forgets that a box has exactly four numbers.
      return page as ObservationPage;
    },
    drive.frame_count,
    onNewRevision,
  );
  observations.invalidate(drive.revision);
  for (const [camera, width] of firstWidths(drive)) pictureWidths.set(camera, width);
  const frames = new FrameStore<ImageBitmap>({
    cameras: drive.camera_names,
    frameCount: drive.frame_count,
    loadPicture: (frame, camera) => loadPicture(drive.id, frame, camera, pictureWidths.get(camera)),
    observations,
  });
  return {
    driveId: drive.id,
    store,
    frames,
    observations,
    crops: new CropStore(drive.id),
    views: createViewStore(),
    pictureWidths,
  };
}

export function ReviewProvider({ drive, children }: { drive: DriveDetail; children: ReactNode }) {
  const client = useQueryClient();
  const [shared, setShared] = useState<Shared | null>(null);

  // biome-ignore lint/correctness/useExhaustiveDependencies: the drive's counts change all the time; what it is does not.
  useEffect(() => {
    const made = share(drive, () => {
      // What this page changes itself is told by the answer.
      if (client.isMutating({ mutationKey: ["decide", drive.id] }) > 0) return;
      void client.invalidateQueries({ queryKey: ["drive", drive.id] });
    });
    const { store, frames } = made;
    frames.begin(store.getState().frame);
    let timer: ReturnType<typeof setTimeout> | undefined;
    const stop = store.subscribe((state, before) => {
      if (state.frame !== before.frame) frames.request(state.frame);
      clearTimeout(timer);
      timer = setTimeout(() => {
        const address = window.location.pathname + writeUrl(state);
        if (address !== window.location.pathname + window.location.search) {
          window.history.replaceState(window.history.state, "", address);
        }
      }, URL_DELAY_MS);
    });
    const onPopState = () => {
      const { frame, ...rest } = readUrl(window.location.search);
      store.setState(rest);
      store.getState().seek(frame);
    };
    window.addEventListener("popstate", onPopState);
    setShared(made);
    return () => {
      stop();
      clearTimeout(timer);
      window.removeEventListener("popstate", onPopState);
      frames.close();
    };
  }, [drive.id, drive.frame_count, client]);

  // Labels that changed elsewhere (a job ended, another person decided).
  useEffect(() => {
    if (!shared) return;
    if (shared.observations.isOlderThan(drive.revision)) {
      shared.observations.invalidate(drive.revision);
      shared.frames.refreshObservations();
      for (const part of ["tracks", "identities", "merges"]) {
        void client.invalidateQueries({ queryKey: ["drive", drive.id, part] });
      }
    }
  }, [shared, drive.revision, drive.id, client]);

  if (!shared) return null;
  return <SharedContext.Provider value={{ ...shared, drive }}>{children}</SharedContext.Provider>;
}

export function useShared() {
  const shared = useContext(SharedContext);
  if (!shared) throw new Error("useShared is for parts of the review page only");
  return shared;
}

export function useReview<T>(selector: (state: ReviewState) => T): T {
  return useStore(useShared().store, selector);
}

/** What is on the screen: one whole frame. */
export function useCommitted(): CommittedFrame<ImageBitmap> | null {
  const { frames } = useShared();
  return useSyncExternalStore(frames.subscribe, frames.committed);
}
