import { afterEach, describe, expect, it, vi } from "vitest";
import { CropStore } from "./pictures";

describe("CropStore", () => {
  afterEach(() => vi.unstubAllGlobals());

  it("fetches what is asked for at once in its order, and what is asked for later before it, unless it comes first", async () => {
    const asked: number[] = [];
    const answers: (() => void)[] = [];
    vi.stubGlobal("fetch", (url: string) => {
      asked.push(Number(/frames\/(\d+)/.exec(url)?.[1]));
      return new Promise((answer) => answers.push(() => answer(new Response(null, { status: 404 }))));
    });
    const store = new CropStore(1);
    const get = (frame: number, first = false) => store.get(frame, "front", { x: 0, y: 0, width: 8, height: 8 }, first);
    const first = [1, 2, 3, 4].map((frame) => get(frame)); // two at a time
    expect(asked).toEqual([1, 2]);
    await Promise.resolve();
    const later = [get(5), get(6), get(7, true)];
    answers[0]?.();
    await first[0];
    await vi.waitFor(() => expect(asked).toEqual([1, 2, 7]));
    for (let done = 1; done < 7; done += 1) {
      await vi.waitFor(() => expect(answers.length).toBeGreaterThan(done));
      answers[done]?.();
    }
    expect(await Promise.all([...first, ...later])).toEqual(Array(7).fill(null));
    expect(asked).toEqual([1, 2, 7, 5, 6, 3, 4]);
    expect(get(3)).toBe(first[2]);
  });
});
