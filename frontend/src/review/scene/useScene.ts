/** One 3D scene of the server for as long as it is shown: made, moved to the playhead, and taken away. */

import { useCallback, useEffect, useRef, useState } from "react";
import { ApiError, api, messageOf, unwrap } from "../../api/client";
import { useShared } from "../ReviewContext";
import { LatestSender } from "./latestSender";

const VIEW_INTERVAL_MS = 60;

export type SceneState =
  | { state: "starting" }
  | { state: "running"; url: string }
  | { state: "noLidar" }
  | { state: "failed"; message: string }
  | { state: "lost"; message: string };

interface View {
  frame_index: number;
  identity_id: number | null;
  theme: "dark" | "light";
}

function remove(sceneId: string): void {
  // The page may be on its way out: `keepalive` lets the request outlive it.
  void fetch(`/api/scenes/${encodeURIComponent(sceneId)}`, { method: "DELETE", keepalive: true }).catch(
    () => undefined,
  );
}

export function useScene(theme: "dark" | "light"): { scene: SceneState; restart: () => void } {
  const { driveId, drive, store } = useShared();
  const [scene, setScene] = useState<SceneState>({ state: "starting" });
  const [attempt, setAttempt] = useState(0);
  const hasLidar = drive.has_lidar;
  const move = useRef<(() => void) | null>(null);
  const latestTheme = useRef(theme);
  useEffect(() => {
    latestTheme.current = theme;
    move.current?.();
  }, [theme]);

  // biome-ignore lint/correctness/useExhaustiveDependencies: `attempt` makes the scene anew.
  useEffect(() => {
    if (!hasLidar) {
      setScene({ state: "noLidar" });
      return;
    }
    const view = (): View => {
      const { frame, identityIds, hover } = store.getState();
      const identity_id = hover?.identityId ?? identityIds[0] ?? null;
      return { frame_index: frame, identity_id, theme: latestTheme.current };
    };
    let left = false;
    let sceneId: string | null = null;
    let stopFollowing = () => {};
    setScene({ state: "starting" });

    const follow = (id: string) => {
      const path = { scene_id: id };
      const sender = new LatestSender(
        async (body: View) => {
          await unwrap(api.PUT("/api/scenes/{scene_id}/view", { params: { path }, body }));
        },
        VIEW_INTERVAL_MS,
        (cause) => {
          if (cause instanceof ApiError) setScene({ state: "lost", message: cause.message });
        },
      );
      const push = () => sender.push(view());
      move.current = push;
      push();
      const unsubscribe = store.subscribe((state, before) => {
        const { frame, identityIds, hover } = before;
        const pointedAt = state.hover?.identityId !== hover?.identityId;
        if (state.frame !== frame || state.identityIds !== identityIds || pointedAt) push();
      });
      stopFollowing = () => {
        move.current = null;
        unsubscribe();
        sender.stop();
      };
    };

    const end = () => {
      left = true;
      stopFollowing();
      if (sceneId) remove(sceneId);
      sceneId = null;
    };

    unwrap(api.POST("/api/drives/{drive_id}/scenes", { params: { path: { drive_id: driveId } }, body: view() })).then(
      (made) => {
        if (left) {
          remove(made.scene_id);
          return;
        }
        sceneId = made.scene_id;
        setScene({ state: "running", url: made.url });
        follow(made.scene_id);
      },
      (cause: unknown) => {
        if (left) return;
        setScene({ state: "failed", message: messageOf(cause) });
      },
    );
    // A page that comes back from the browser's back-forward cache has no scene any more.
    const onShow = (event: PageTransitionEvent) => event.persisted && setAttempt((n) => n + 1);
    window.addEventListener("pagehide", end);
    window.addEventListener("pageshow", onShow);
    return () => {
      window.removeEventListener("pagehide", end);
      window.removeEventListener("pageshow", onShow);
      end();
    };
  }, [driveId, hasLidar, store, attempt]);

  const restart = useCallback(() => setAttempt((n) => n + 1), []);
  return { scene, restart };
}
