import { describe, expect, it } from "vitest";
import type { Merge } from "../../api/types";
import { byPriority, keepPriorities, listOf, members, nextOpen, upNext } from "./queueLists";

const merge = (id: number, priority = 1, more: Partial<Merge> = {}) =>
  ({ id, priority, state: "proposed", decided_by: "machine", ...more }) as Merge;

const decided = (id: number, priority = 1) => merge(id, priority, { state: "accepted", decided_by: "person" });

describe("the lists of the queue", () => {
  it.each<[Partial<Merge>, string]>([
    [{ state: "proposed", decided_by: "machine" }, "open"],
    [{ state: "accepted", decided_by: "machine" }, "automatic"],
    [{ state: "unsure", decided_by: "person" }, "unsure"],
    [{ state: "accepted", decided_by: "person" }, "decided"],
    [{ state: "rejected", decided_by: "person" }, "decided"],
    // rejected by the machine: nothing waits there, it is looked up among the decided
    [{ state: "rejected", decided_by: "machine" }, "decided"],
  ])("%o is in %s", (is, list) => {
    expect(listOf(merge(1, 1, is))).toBe(list);
  });

  it("goes from what matters most to what matters least; equal ones stay in order", () => {
    const all = [merge(4, 2), merge(2, 9), merge(3, 2), merge(1, 0)];
    expect(all.sort(byPriority).map((one) => one.id)).toEqual([2, 3, 4, 1]);
  });

  it("keeps decided merges in their place, and puts new ones behind", () => {
    const first = members([], [merge(1, 5), merge(2, 9), decided(3)], "open");
    expect(first).toEqual([2, 1]);
    expect(members(first, [merge(1, 5), decided(2), merge(4, 99)], "open")).toEqual([2, 1, 4]);
    expect(members(first, [decided(1), decided(2)], "open")).toBe(first);
    expect(members(first, [merge(1)], "open")).toEqual([1]); // 2 is gone: the drive was labelled anew
  });

  it.each([
    ["the next that waits", [merge(1), decided(2), decided(3), merge(4)], 2, 4],
    ["one above, when none below waits", [merge(1), decided(2), decided(3)], 3, 1],
    ["none, when all are decided", [decided(1), decided(2)], 1, null],
  ] as const)("shows after a decision %s", (_, order, id, next) => {
    expect(nextOpen("open", order, id)?.id ?? null).toBe(next);
  });

  it("knows what to fetch ahead", () => {
    const order = [merge(1), decided(2), merge(3), merge(4), merge(5)];
    expect(upNext("open", order, 1, 2).map((one) => one.id)).toEqual([3, 4]);
    expect(upNext("open", order, 5, 2)).toEqual([]);
  });

  it("does not reorder when decisions change what others are worth", () => {
    const after = keepPriorities([merge(1, 5), merge(2, 3)], [merge(1, 1), merge(2, 3), merge(7, 4)]);
    expect(after.map((one) => one.priority)).toEqual([5, 3, 4]);
    expect(keepPriorities(undefined, [merge(1, 1)])[0]?.priority).toBe(1);
  });
});
