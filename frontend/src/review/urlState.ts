/** What of the page lives in its address: the frame, the selected identities, the open tab and the open merge. */

import { type IdentityFilter, readFilter, writeFilter } from "./identities/filter";
import { type IdentitySort, SORTS } from "./identities/sort";

export type Tab = "merges" | "identities" | "selected" | "export";
export const TABS: readonly Tab[] = ["merges", "identities", "selected", "export"];

/** What fills the page: the cameras with their panel, or the merge queue. */
export type View = "cameras" | "queue";

export interface UrlState {
  view: View;
  frame: number;
  identityIds: number[];
  tab: Tab;
  mergeId: number | null;
  /** Which identities are looked for, and their order. */
  filter: IdentityFilter;
  sort: IdentitySort;
}

function wholeNumber(value: string | null): number | null {
  return value !== null && /^\d{1,9}$/.test(value) ? Number(value) : null;
}

/** Reads an address; whatever it cannot make sense of is as if it were not there. Frames in it count from 0. */
export function readUrl(search: string): UrlState {
  const query = new URLSearchParams(search);
  const ids = (query.get("identity") ?? "").split(",").map((part) => wholeNumber(part));
  const tab = query.get("tab") as Tab | null;
  return {
    view: query.get("view") === "queue" ? "queue" : "cameras",
    frame: wholeNumber(query.get("frame")) ?? 0,
    identityIds: [...new Set(ids.filter((id) => id !== null))],
    tab: tab && TABS.includes(tab) ? tab : "merges",
    mergeId: wholeNumber(query.get("merge")),
    filter: readFilter(query.get("find")),
    sort: SORTS.find((sort) => sort === query.get("sort")) ?? "frames",
  };
}

/** Writes what differs from a fresh page. */
export function writeUrl(state: UrlState): string {
  const parts: string[] = [];
  if (state.view !== "cameras") parts.push(`view=${state.view}`);
  if (state.frame !== 0) parts.push(`frame=${state.frame}`);
  if (state.identityIds.length > 0) parts.push(`identity=${state.identityIds.join(",")}`);
  if (state.tab !== "merges") parts.push(`tab=${state.tab}`);
  if (state.mergeId !== null) parts.push(`merge=${state.mergeId}`);
  const find = writeFilter(state.filter);
  if (find !== "") parts.push(`find=${encodeURIComponent(find).replaceAll("%3A", ":").replaceAll("%2C", ",")}`);
  if (state.sort !== "frames") parts.push(`sort=${state.sort}`);
  return parts.length > 0 ? `?${parts.join("&")}` : "";
}
