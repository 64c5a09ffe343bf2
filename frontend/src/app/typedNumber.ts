/** The number that a person has typed so far; null while there is none. A field gives "0.50" as words, not as .5. */
export function typedNumber(value: string | number): number | null {
  const number = typeof value === "number" ? value : Number(value.trim() || Number.NaN);
  return Number.isFinite(number) ? number : null;
}
