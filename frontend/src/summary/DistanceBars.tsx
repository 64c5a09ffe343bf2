import { text } from "../strings";
import type { Bin } from "./histogram";
import { Bars } from "./Plots";

interface DistanceBarsProps {
  bins: readonly Bin[];
  sources: readonly string[];
  /** The highest bar that the plot must hold, so that bars shrink while the threshold moves and nothing is rescaled. */
  most: number;
}

/** Labels from near to far, a bar each, by where they come from. */
export function DistanceBars({ bins, sources, most }: DistanceBarsProps) {
  const rows = bins.map((bin) => ({ name: rangeName(bin.range), values: bin.bySource }));
  return <Bars caption={text.summary.byDistance} rows={rows} sources={sources} most={most} />;
}

function rangeName(range: Bin["range"]): string {
  if (range === null) return text.summary.distanceUnknown;
  return range.to === null ? text.summary.beyond(range.from) : text.summary.metresBetween(range.from, range.to);
}
