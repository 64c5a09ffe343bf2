import { count } from "../app/format";
import { text } from "../strings";
import classes from "./Plots.module.css";

interface BarsProps {
  rows: readonly { name: string; values: readonly number[] }[];
  sources: readonly string[];
  caption?: string;
  /** The longest bar that the plot must hold; the longest that it has, where it is left out. */
  most?: number;
}

/** A bar for each row, its parts one after the other. */
export function Bars({ rows, sources, caption, most: asked }: BarsProps) {
  const totals = rows.map((row) => row.values.reduce((sum, one) => sum + one, 0));
  const most = Math.max(1, ...(asked === undefined ? totals : [asked]));
  return (
    <table className={classes.bars}>
      {caption && <caption>{caption}</caption>}
      <tbody>
        {rows.map((row, index) => (
          <tr key={row.name}>
            <th scope="row">{row.name}</th>
            <td className={classes.bar}>
              <span className={classes.stack} aria-hidden>
                {row.values.map((value, part) => (
                  <span key={sources[part]} data-source={sources[part]} style={{ width: `${(100 * value) / most}%` }} />
                ))}
              </span>
            </td>
            <td className={classes.number}>{count(totals[index] as number)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/** What the colours of the parts mean. */
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

interface Series {
  name: string;
  values: readonly number[];
}

/** Two bars for each name, one above the other: before and after. */
export function PairedBars({ names, first, second }: { names: readonly string[]; first: Series; second: Series }) {
  const most = Math.max(1, ...first.values, ...second.values);
  return (
    <table className={classes.bars}>
      <thead>
        <tr>
          <td />
          <td />
          <th scope="col">{first.name}</th>
          <th scope="col">{second.name}</th>
        </tr>
      </thead>
      <tbody>
        {names.map((name, row) => (
          <tr key={name}>
            <th scope="row">{name}</th>
            <td className={classes.bar}>
              <span className={classes.pair} aria-hidden>
                <span data-series="first" style={{ width: `${(100 * (first.values[row] as number)) / most}%` }} />
                <span data-series="second" style={{ width: `${(100 * (second.values[row] as number)) / most}%` }} />
              </span>
            </td>
            <td className={classes.number} data-series="first">
              {count(first.values[row] as number)}
            </td>
            <td className={classes.number} data-series="second">
              {count(second.values[row] as number)}
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
