import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { LatestSender } from "./latestSender";

describe("LatestSender", () => {
  beforeEach(() => {
    vi.useFakeTimers();
  });
  afterEach(() => {
    vi.useRealTimers();
  });

  it("sends the first at once, then only the newest after the interval", async () => {
    const sent: number[] = [];
    const sender = new LatestSender<number>(
      async (value) => {
        sent.push(value);
      },
      50,
      () => undefined,
    );
    sender.push(1);
    sender.push(2);
    sender.push(3);
    expect(sent).toEqual([1]);
    await vi.advanceTimersByTimeAsync(49);
    expect(sent).toEqual([1]);
    await vi.advanceTimersByTimeAsync(1);
    expect(sent).toEqual([1, 3]);
    await vi.advanceTimersByTimeAsync(500);
    expect(sent).toEqual([1, 3]);
  });

  it("has one on its way at a time, however slow the server", async () => {
    const sent: number[] = [];
    let answer = () => {};
    const sender = new LatestSender<number>(
      (value) => {
        sent.push(value);
        return new Promise((resolve) => {
          answer = resolve;
        });
      },
      50,
      () => undefined,
    );
    sender.push(1);
    sender.push(2);
    await vi.advanceTimersByTimeAsync(1000);
    expect(sent).toEqual([1]);
    answer();
    await vi.advanceTimersByTimeAsync(0);
    expect(sent).toEqual([1, 2]);
  });

  it("tells of a failure, goes on after it, and is silent once stopped", async () => {
    const failures: unknown[] = [];
    const sent: number[] = [];
    const sender = new LatestSender<number>(
      (value) => {
        sent.push(value);
        return Promise.reject(new Error(`no ${value}`));
      },
      50,
      (cause) => failures.push(cause),
    );
    sender.push(1);
    await vi.advanceTimersByTimeAsync(60);
    sender.push(2);
    sender.stop();
    await vi.advanceTimersByTimeAsync(60);
    sender.push(3);
    expect(sent).toEqual([1, 2]);
    expect(failures).toEqual([new Error("no 1")]);
  });
});
