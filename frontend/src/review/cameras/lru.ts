/** A map that forgets what was not used for longest, once the weights in it exceed a limit. */
export class LeastRecentlyUsed<K, V> {
  private readonly entries = new Map<K, { value: V; weight: number }>();
  private total = 0;

  constructor(
    private readonly limit: number,
    private readonly onEvict: (value: V, key: K) => void = () => undefined,
    /** Entries that must stay, such as what is on the screen. */
    private readonly isPinned: (key: K) => boolean = () => false,
  ) {}

  get(key: K): V | undefined {
    const entry = this.entries.get(key);
    if (!entry) return undefined;
    this.entries.delete(key);
    this.entries.set(key, entry);
    return entry.value;
  }

  has(key: K): boolean {
    return this.entries.has(key);
  }

  set(key: K, value: V, weight = 1): void {
    this.drop(key);
    this.entries.set(key, { value, weight });
    this.total += weight;
    for (const old of [...this.entries.keys()]) {
      if (this.total <= this.limit) break;
      if (old !== key && !this.isPinned(old)) this.drop(old);
    }
  }

  /** All values, from the one that was not used for longest. */
  values(): V[] {
    return [...this.entries.values()].map((entry) => entry.value);
  }

  delete(key: K): void {
    this.drop(key);
  }

  clear(): void {
    for (const key of [...this.entries.keys()]) this.drop(key);
  }

  private drop(key: K): void {
    const entry = this.entries.get(key);
    if (!entry) return;
    this.entries.delete(key);
    this.total -= entry.weight;
    this.onEvict(entry.value, key);
  }
}
