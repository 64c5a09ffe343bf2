import { count } from "../app/format";
import { text } from "../strings";
import classes from "./DistanceBars.module.css";
import type { Bin } from "./histogram";

interface DistanceBarsProps {
  bins: readonly Bin[];
  sources: readonly string[];
  /** The highest bar that the plot must hold, so that bars shrink while the threshold moves and nothing is rescaled. */
  most: number;
}

/** Labels from near to far, a bar each, by where they come from. */
export function DistanceBars({ bins, sources, most }: DistanceBarsProps) {
  return (
    <table className={classes.bars}>
      <caption>{text.summary.byDistance}</caption>
      <tbody>
        {bins.map((bin) => {
          const total = bin.bySource.reduce((sum, one) => sum + one, 0);
          const name = rangeName(bin.range);
          return (
            <tr key={name}>
              <th scope="row">{name}</th>
              <td className={classes.bar}>
                <span className={classes.stack} aria-hidden>
                  {bin.bySource.map((n, source) => (
                    <span
                      key={sources[source]}
                      data-source={sources[source]}
                      style={{ width: `${most === 0 ? 0 : (100 * n) / most}%` }}
                    />
                  ))}
                </span>
              </td>
              <td className={classes.number}>{count(total)}</td>
            </tr>
          );
        })}
      </tbody>
    </table>
  );
}

function rangeName(range: Bin["range"]): string {
  if (range === null) return text.summary.distanceUnknown;
  return range.to === null ? text.summary.beyond(range.from) : text.summary.metresBetween(range.from, range.to);
}

export function SourceLegend({ sources }: { sources: readonly string[] }) {
  return (
    <ul className={classes.legend}>
      {sources.map((source) => (
        <li key={source}>
          <span data-source={source} aria-hidden />
          {text.summary.sources[source as keyof typeof text.summary.sources] ?? source}
        </li>
      ))}
    </ul>
  );
}
