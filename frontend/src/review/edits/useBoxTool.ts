/** Drawing boxes: handles on that of the selected object, a new one anywhere else. Offered to the camera views as a tool. */

import { useEffect, useRef } from "react";
import { create } from "zustand";
import type { Observation } from "../../api/types";
import { type PointerTool, type ToolPoint, usePointerTool } from "../cameras/pointerTool";
import { useShared } from "../ReviewContext";
import { type Box, cursorOf, drag, type Grip, gripAt, handlePoints, insidePicture, ordered } from "./handles";
import { useEdits } from "./useEdits";

const NEAR_PX = 7;
const HANDLE_PX = 7;
const LINE = "#ffffff";
const RIM = "rgba(0, 0, 0, 0.75)";

/** Whether boxes are drawn now, and of which class those of new objects are. */
export const useDrawing = create<{
  on: boolean;
  className: string | null;
  set: (on: boolean) => void;
  setClass: (name: string | null) => void;
}>()((set) => ({
  on: false,
  className: null,
  set: (on) => set({ on }),
  setClass: (className) => set({ className }),
}));

interface Gesture {
  camera: string;
  frame: number;
  from: { x: number; y: number };
  grip: Grip | null;
  of: Observation | null;
  box: Box;
}

/** While drawing is on, the camera views have the tool. */
export function useBoxTool(): void {
  const { drive, store, frames } = useShared();
  const { edit } = useEdits();
  const on = useDrawing((state) => state.on);
  const latest = useRef({ edit, drive });
  latest.current = { edit, drive };

  useEffect(() => {
    if (!on) return;
    const { set, repaint } = usePointerTool.getState();
    let gesture: Gesture | null = null;
    let saving: Gesture | null = null; // stays on the screen until the server's answer takes its place
    let saved = Promise.resolve(); // one after the other: the next box may be of the object that the last one made

    const target = (camera: string, frame: number): Observation | null => {
      const shown = frames.committed();
      const [selected, ...more] = store.getState().identityIds;
      if (!shown || shown.frame !== frame || selected === undefined || more.length > 0) return null;
      return shown.observations.find((one) => one.camera === camera && one.identity_id === selected) ?? null;
    };
    const save = async (done: Gesture) => {
      const picture = latest.current.drive.cameras.find((one) => one.name === done.camera);
      const box = picture && insidePicture(done.box, picture.width_px, picture.height_px);
      if (box) {
        const [selected, ...more] = store.getState().identityIds;
        const one = more.length === 0 ? selected : undefined;
        await latest.current.edit({
          kind: "box",
          camera: done.camera,
          frame_index: done.frame,
          box: [...box],
          track_id: done.of?.track_id ?? null,
          identity_id: done.of || one === undefined ? null : one,
          class_name: done.of || one !== undefined ? null : classOfNew(latest.current.drive.class_names),
          interpolate: true,
        });
      }
      if (saving === done) saving = null;
      repaint();
    };

    const tool: PointerTool = {
      down: (at) => {
        store.getState().setPlaying(false);
        const of = target(at.camera, at.frame);
        const box = of && (of.box as unknown as Box);
        const grip = box && gripAt(box, at.x, at.y, NEAR_PX * at.pxPerScreenPx);
        // Beside the object's own box there is nothing to draw for it: the click selects.
        if (of && !grip) return false;
        const { camera, frame } = at;
        gesture = { camera, frame, from: { x: at.x, y: at.y }, grip, of, box: box ?? [at.x, at.y, at.x, at.y] };
        return true;
      },
      move: (at) => {
        if (!gesture) return;
        gesture.box = boxOf(gesture, at);
        repaint();
      },
      up: (at) => {
        if (!gesture) return;
        const moved = Math.hypot(at.x - gesture.from.x, at.y - gesture.from.y) > 2 * at.pxPerScreenPx;
        gesture.box = boxOf(gesture, at);
        const done = gesture;
        gesture = null;
        if (moved) {
          saving = done;
          saved = saved.then(() => save(done));
        }
        repaint();
      },
      cancel: () => {
        gesture = null;
        repaint();
      },
      cursor: (at) => {
        const of = target(at.camera, at.frame);
        if (!of) return "crosshair";
        const grip = gripAt(of.box as unknown as Box, at.x, at.y, NEAR_PX * at.pxPerScreenPx);
        return grip && cursorOf(grip);
      },
      paint: (ctx, { camera, frame, transform }) => {
        const of = target(camera, frame);
        const mine = [gesture, saving].find((one) => one?.camera === camera && one.frame === frame);
        const box = mine?.box ?? (of && (of.box as unknown as Box));
        if (!box) return;
        const toScreen = ([x, y]: readonly [number, number]) =>
          [transform.offsetX + x * transform.scale, transform.offsetY + y * transform.scale] as const;
        const [left, top] = toScreen([box[0], box[1]]);
        const [right, bottom] = toScreen([box[2], box[3]]);
        ctx.save();
        for (const [style, width] of [
          [RIM, 4],
          [LINE, 1.5],
        ] as const) {
          ctx.strokeStyle = style;
          ctx.lineWidth = width;
          ctx.strokeRect(left, top, right - left, bottom - top);
        }
        ctx.fillStyle = LINE;
        ctx.strokeStyle = RIM;
        ctx.lineWidth = 1;
        for (const [x, y] of handlePoints(box).map(toScreen)) {
          ctx.fillRect(x - HANDLE_PX / 2, y - HANDLE_PX / 2, HANDLE_PX, HANDLE_PX);
          ctx.strokeRect(x - HANDLE_PX / 2, y - HANDLE_PX / 2, HANDLE_PX, HANDLE_PX);
        }
        ctx.restore();
      },
    };
    set(tool);
    const stop = store.subscribe(repaint);
    return () => {
      stop();
      set(null);
    };
  }, [on, store, frames]);
}

function boxOf(gesture: Gesture, at: ToolPoint): Box {
  const { from, grip, of } = gesture;
  if (!grip || !of) return ordered([from.x, from.y, at.x, at.y]);
  return drag(of.box as unknown as Box, grip, at.x - from.x, at.y - from.y);
}

function classOfNew(names: readonly string[]): string | null {
  return useDrawing.getState().className ?? names[0] ?? null;
}
