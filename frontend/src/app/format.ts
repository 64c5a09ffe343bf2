/** Numbers as a person reads them. */

const integer = new Intl.NumberFormat("en");

export function count(n: number): string {
  return integer.format(n);
}

export function plural(n: number, one: string, many = `${one}s`): string {
  return `${integer.format(n)} ${n === 1 ? one : many}`;
}

/** 0.9 -> "0.90"; null -> "–" */
export function score(value: number | null | undefined): string {
  return value == null ? "–" : value.toFixed(2);
}

/** 0.1967 -> "19.7%"; null -> "–" */
export function percent(value: number | null | undefined): string {
  return value == null ? "–" : `${(100 * value).toFixed(1)}%`;
}

export function metres(value: number | null | undefined): string {
  return value == null || !Number.isFinite(value) ? "–" : `${value.toFixed(value < 10 ? 2 : 1)} m`;
}

const moment = new Intl.DateTimeFormat("en", { dateStyle: "medium", timeStyle: "short" });

/** "2026-11-25T20:50:00Z" -> "Nov 25, 2026, 8:50 PM", in the time of this place. */
export function when(time: string): string {
  return moment.format(new Date(time));
}

/** 95_300 -> "1:35.3" */
export function clock(ms: number): string {
  const tenths = Math.round(ms / 100);
  const minutes = Math.floor(tenths / 600);
  const seconds = (tenths % 600) / 10;
  return `${minutes}:${seconds.toFixed(1).padStart(4, "0")}`;
}

/** 23_900 -> "23.9 s", 95_300 -> "1 min 35 s" */
export function duration(ms: number): string {
  const seconds = ms / 1000;
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  if (whole < 3600) return `${Math.floor(whole / 60)} min ${whole % 60} s`;
  return `${Math.floor(whole / 3600)} h ${Math.floor((whole % 3600) / 60)} min`;
}

/** Sizes in powers of 1000, as disks and browsers count them. */
export function bytes(n: number): string {
  const units = ["B", "kB", "MB", "GB", "TB"];
  let value = n;
  let unit = 0;
  while (value >= 1000 && unit < units.length - 1) {
    value /= 1000;
    unit += 1;
  }
  return `${unit === 0 ? value : value.toFixed(value < 10 ? 1 : 0)} ${units[unit]}`;
}

/** A clause of the machine as a sentence: "boxes agree" -> "Boxes agree." */
export function sentence(clause: string): string {
  const words = clause.trim();
  if (words === "") return "";
  const capital = words.charAt(0).toUpperCase() + words.slice(1);
  return /[.!?]$/.test(capital) ? capital : `${capital}.`;
}
