/** What the pointer does on a camera's picture: point at boxes, select, zoom with the wheel, move what is zoomed. */

import { type PointerEvent, type RefObject, useEffect, useRef } from "react";
import type { Observation } from "../../api/types";
import { useShared } from "../ReviewContext";
import { observationAt } from "./hitTest";
import type { Tile } from "./layout";
import { type ToolPoint, usePointerTool } from "./pointerTool";
import { FIT, panBy, type Transform, toPicture, zoomAt } from "./viewport";

const HIT_SLACK_PX = 3;
const DRAG_FROM_PX = 4;
const DOUBLE_CLICK_ZOOM = 3;
const WHEEL_SPEED = 0.0018;
const PINCH_SPEED = 0.012;
/** Wheels that count in lines say few. */
const PX_PER_LINE = 24;

interface Target {
  camera: string;
  frame: number;
  observations: readonly Observation[];
  tile: Tile;
  transform: Transform;
}

type Gesture = { kind: "tool" } | { kind: "press" | "pan"; x: number; y: number };

export function usePointer(canvas: RefObject<HTMLCanvasElement | null>, target: Target) {
  const { store, views } = useShared();
  const gesture = useRef<Gesture | null>(null);
  const latest = useRef(target);
  latest.current = target;

  useWheel(canvas, latest);

  const toolPoint = (event: PointerEvent<HTMLCanvasElement>): ToolPoint => {
    const { camera, frame, transform } = latest.current;
    const at = toPicture(transform, offset(event));
    return { camera, frame, ...at, pxPerScreenPx: 1 / transform.scale, event: event.nativeEvent };
  };
  const under = (event: PointerEvent<HTMLCanvasElement>) => {
    const { observations, transform } = latest.current;
    const at = toPicture(transform, offset(event));
    return observationAt(observations, at.x, at.y, HIT_SLACK_PX / transform.scale);
  };
  const point = (event: PointerEvent<HTMLCanvasElement>) => {
    const one = under(event);
    const { hover: before, setHover } = store.getState();
    if (one?.id !== before?.observationId) {
      setHover(one && { identityId: one.identity_id, observationId: one.id });
    }
  };

  return {
    onPointerEnter: () => views.getState().setActive(target.camera),
    onPointerDown: (event: PointerEvent<HTMLCanvasElement>) => {
      if (event.button !== 0) return;
      event.currentTarget.setPointerCapture(event.pointerId);
      const taken = usePointerTool.getState().tool?.down(toolPoint(event)) === true;
      gesture.current = taken ? { kind: "tool" } : { kind: "press", x: event.clientX, y: event.clientY };
    },
    onPointerMove: (event: PointerEvent<HTMLCanvasElement>) => {
      const now = gesture.current;
      const { tool } = usePointerTool.getState();
      if (now?.kind === "tool") {
        tool?.move?.(toolPoint(event));
        return;
      }
      if (!now) {
        point(event);
        event.currentTarget.style.cursor = tool?.cursor?.(toolPoint(event)) ?? "";
        return;
      }
      const by = { x: event.clientX - now.x, y: event.clientY - now.y };
      if (now.kind === "press" && Math.hypot(by.x, by.y) < DRAG_FROM_PX) return;
      gesture.current = { kind: "pan", x: event.clientX, y: event.clientY };
      const { camera, tile } = latest.current;
      views.getState().change(camera, (view) => panBy(view, { x: by.x / tile.width, y: by.y / tile.height }));
    },
    onPointerUp: (event: PointerEvent<HTMLCanvasElement>) => {
      const now = gesture.current;
      gesture.current = null;
      if (now?.kind === "tool") usePointerTool.getState().tool?.up?.(toolPoint(event));
      if (now?.kind !== "press") return;
      const one = under(event);
      if (one && (event.ctrlKey || event.metaKey || event.shiftKey)) store.getState().toggle(one.identity_id);
      else if (one) store.getState().select([one.identity_id], "selected");
      else store.getState().clear();
    },
    onPointerCancel: () => {
      if (gesture.current?.kind === "tool") usePointerTool.getState().tool?.cancel?.();
      gesture.current = null;
    },
    onPointerLeave: () => store.getState().setHover(null),
    onDoubleClick: (event: React.MouseEvent<HTMLCanvasElement>) => {
      const { camera, tile } = latest.current;
      const at = offset(event);
      views
        .getState()
        .change(camera, (view) =>
          view.zoom > 1 ? FIT : zoomAt(view, DOUBLE_CLICK_ZOOM, { x: at.x / tile.width, y: at.y / tile.height }),
        );
    },
  };
}

/** React listens to wheels passively; a wheel that zooms must not scroll or zoom the page. */
function useWheel(canvas: RefObject<HTMLCanvasElement | null>, latest: RefObject<Target>): void {
  const { views } = useShared();
  useEffect(() => {
    const element = canvas.current;
    if (!element) return;
    const onWheel = (event: WheelEvent) => {
      event.preventDefault();
      const { camera, tile } = latest.current;
      const lines = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : PX_PER_LINE;
      // A pinch on a trackpad comes as a wheel with Ctrl.
      const factor = Math.exp(-event.deltaY * lines * (event.ctrlKey ? PINCH_SPEED : WHEEL_SPEED));
      const at = { x: event.offsetX / tile.width, y: event.offsetY / tile.height };
      views.getState().change(camera, (view) => zoomAt(view, factor, at));
    };
    element.addEventListener("wheel", onWheel, { passive: false });
    return () => element.removeEventListener("wheel", onWheel);
  }, [canvas, latest, views]);
}

function offset(event: { clientX: number; clientY: number; currentTarget: Element }): { x: number; y: number } {
  const bounds = event.currentTarget.getBoundingClientRect();
  return { x: event.clientX - bounds.left, y: event.clientY - bounds.top };
}
