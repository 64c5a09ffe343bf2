/** How pictures and boxes look, kept in this browser: what colours mean, and how bright the pictures are. */

import { create } from "zustand";
import { persist } from "zustand/middleware";
import { COLOURINGS, type Colouring } from "./colouring";

export interface Adjustments {
  brightness: number;
  contrast: number;
  gamma: number;
}

export const UNCHANGED: Adjustments = { brightness: 1, contrast: 1, gamma: 1 };
export const LIMITS: Record<keyof Adjustments, { min: number; max: number }> = {
  brightness: { min: 0.4, max: 2.5 },
  contrast: { min: 0.4, max: 2.5 },
  gamma: { min: 0.3, max: 3 },
};
export const GAMMA_FILTER_ID = "picture-gamma";

interface Appearance {
  colouring: Colouring;
  adjustments: Adjustments;
  setColouring: (colouring: Colouring) => void;
  adjust: (change: Partial<Adjustments>) => void;
}

export const useAppearance = create<Appearance>()(
  persist(
    (set, get) => ({
      colouring: "identity",
      adjustments: UNCHANGED,
      setColouring: (colouring) => set({ colouring }),
      adjust: (change) => set({ adjustments: { ...get().adjustments, ...change } }),
    }),
    {
      name: "hindsight.appearance",
      partialize: ({ colouring, adjustments }) => ({ colouring, adjustments }),
      merge: (stored, current) => ({ ...current, ...sane(stored) }),
    },
  ),
);

/** What of a stored appearance makes sense. */
export function sane(stored: unknown): Partial<Pick<Appearance, "colouring" | "adjustments">> {
  const { colouring, adjustments } = (stored ?? {}) as { colouring?: unknown; adjustments?: Record<string, unknown> };
  const known = COLOURINGS.find((one) => one === colouring);
  const value = (name: keyof Adjustments) => {
    const said = adjustments?.[name];
    const { min, max } = LIMITS[name];
    return typeof said === "number" && said >= min && said <= max ? said : 1;
  };
  return {
    ...(known && { colouring: known }),
    adjustments: { brightness: value("brightness"), contrast: value("contrast"), gamma: value("gamma") },
  };
}

/** The CSS filter of the pictures; undefined where nothing is changed, which costs nothing. */
export function filterOf({ brightness, contrast, gamma }: Adjustments): string | undefined {
  const parts: string[] = [];
  if (gamma !== 1) parts.push(`url(#${GAMMA_FILTER_ID})`);
  if (brightness !== 1) parts.push(`brightness(${brightness})`);
  if (contrast !== 1) parts.push(`contrast(${contrast})`);
  return parts.length > 0 ? parts.join(" ") : undefined;
}
