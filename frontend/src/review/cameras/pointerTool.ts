/**
 * A tool that takes the pointer inside the camera views before they select and pan: to draw a box, or to drag handles.
 *
 * Whoever offers one puts it into this store, and takes it away again. Points are px of the original picture, so a tool
 * knows nothing of pan and zoom; it paints over the boxes with the view's transform.
 */

import { create } from "zustand";
import type { Transform } from "./viewport";

export interface ToolPoint {
  camera: string;
  /** The frame on the screen. */
  frame: number;
  x: number;
  y: number;
  /** So many px of the picture are one CSS px: how near is near, at any zoom. */
  pxPerScreenPx: number;
  event: PointerEvent;
}

export interface PointerTool {
  /** True takes the pointer: `move` and then `up` or `cancel` follow, and the view neither selects nor pans. */
  down: (at: ToolPoint) => boolean;
  move?: (at: ToolPoint) => void;
  up?: (at: ToolPoint) => void;
  cancel?: () => void;
  /** The CSS cursor over a point; null leaves the view's own. */
  cursor?: (at: ToolPoint) => string | null;
  /** Paints over the boxes of one view; the context's unit is the CSS px of the tile. */
  paint?: (ctx: CanvasRenderingContext2D, view: { camera: string; frame: number; transform: Transform }) => void;
}

interface ToolStore {
  tool: PointerTool | null;
  /** Grows when the tool wants to be painted anew. */
  painted: number;
  set: (tool: PointerTool | null) => void;
  repaint: () => void;
}

export const usePointerTool = create<ToolStore>()((set, get) => ({
  tool: null,
  painted: 0,
  set: (tool) => set({ tool, painted: get().painted + 1 }),
  repaint: () => set({ painted: get().painted + 1 }),
}));
