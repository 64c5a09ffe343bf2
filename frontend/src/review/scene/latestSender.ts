/**
 * Sends the newest of many values: one at a time, not more often than every `intervalMs`. What was overtaken while
 * another was on its way is never sent.
 */
export class LatestSender<T> {
  private next: { value: T } | null = null;
  private busy = false;
  private timer: ReturnType<typeof setTimeout> | null = null;
  private stopped = false;

  constructor(
    private readonly send: (value: T) => Promise<void>,
    private readonly intervalMs: number,
    private readonly onError: (cause: unknown) => void,
  ) {}

  push(value: T): void {
    if (this.stopped) return;
    this.next = { value };
    this.flush();
  }

  stop(): void {
    this.stopped = true;
    this.next = null;
    if (this.timer) clearTimeout(this.timer);
  }

  private flush(): void {
    if (this.busy || this.timer || !this.next || this.stopped) return;
    const { value } = this.next;
    this.next = null;
    this.busy = true;
    this.timer = setTimeout(() => {
      this.timer = null;
      this.flush();
    }, this.intervalMs);
    this.send(value)
      .catch((cause: unknown) => {
        if (!this.stopped) this.onError(cause);
      })
      .finally(() => {
        this.busy = false;
        this.flush();
      });
  }
}
