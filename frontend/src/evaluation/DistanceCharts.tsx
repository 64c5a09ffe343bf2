import { VisuallyHidden } from "@mantine/core";
import { useMemo } from "react";
import type { Evaluation } from "../api/types";
import pageClasses from "../app/DrivePage.module.css";
import { count, percent } from "../app/format";
import { useSize } from "../app/useSize";
import { text } from "../strings";
import classes from "./EvaluationPage.module.css";
import { type Bin, binsOf, iousOf, METHODS, type Method, runsOf } from "./figures";
import { MarkShape, MethodMark } from "./MethodMark";

const HEIGHT_PX = 260;
const MARGIN = { left: 46, right: 14, top: 10, bottom: 62 };
const SHARES = [0, 0.25, 0.5, 0.75, 1];

/** Recall from near to far, a chart for each IoU. */
export function DistanceCharts({ rows }: { rows: Evaluation["by_distance"] }) {
  return (
    <section className={pageClasses.card} aria-labelledby="distance">
      <div className={classes.cardHead}>
        <h2 id="distance" className={classes.heading}>
          {text.evaluation.distanceTitle}
        </h2>
        <ul className={classes.legend}>
          {METHODS.map((method) => (
            <li key={method}>
              <MethodMark method={method} />
              {text.evaluation.methods[method]}
            </li>
          ))}
        </ul>
      </div>
      {rows.length === 0 ? (
        <p className={classes.caption}>{text.evaluation.noDistances}</p>
      ) : (
        <>
          <div className={classes.charts}>
            {iousOf(rows).map((iou) => (
              <Chart key={iou} iou={iou} bins={binsOf(rows, iou)} />
            ))}
          </div>
          <p className={classes.caption}>{text.evaluation.distanceCaption}</p>
        </>
      )}
    </section>
  );
}

function Chart({ iou, bins }: { iou: number; bins: Bin[] }) {
  const [ref, { width }] = useSize<HTMLDivElement>();
  const from = bins[0]?.start ?? 0;
  const to = bins.at(-1)?.stop ?? 1;
  const inner = {
    width: Math.max(0, width - MARGIN.left - MARGIN.right),
    height: HEIGHT_PX - MARGIN.top - MARGIN.bottom,
  };
  const x = (metres: number) => MARGIN.left + (inner.width * (metres - from)) / (to - from);
  const y = (share: number) => MARGIN.top + inner.height * (1 - share);
  const bottom = y(0);
  const edges = [...bins.map((bin) => bin.start), to];
  const name = `${text.evaluation.distanceTitle}, ${text.evaluation.atIou(iou)}`;
  return (
    <figure className={classes.chart}>
      <figcaption>{text.evaluation.atIou(iou)}</figcaption>
      <div ref={ref}>
        {width > 0 && (
          <svg width={width} height={HEIGHT_PX} role="img" aria-label={name}>
            {SHARES.map((share) => (
              <g key={share}>
                <line
                  className={classes.grid}
                  x1={MARGIN.left}
                  x2={MARGIN.left + inner.width}
                  y1={y(share)}
                  y2={y(share)}
                />
                <text className={classes.tick} x={MARGIN.left - 8} y={y(share)} dy="0.35em" textAnchor="end">
                  {100 * share}%
                </text>
              </g>
            ))}
            {edges.map((edge) => (
              <g key={edge}>
                <line className={classes.edge} x1={x(edge)} x2={x(edge)} y1={bottom} y2={bottom + 5} />
                <text className={classes.tick} x={x(edge)} y={bottom + 18} textAnchor="middle">
                  {edge}
                </text>
              </g>
            ))}
            {bins.map((bin) => (
              <text key={bin.start} className={classes.tick} x={x(middleOf(bin))} y={bottom + 34} textAnchor="middle">
                {count(bin.count)}
              </text>
            ))}
            <text className={classes.tick} x={MARGIN.left - 8} y={bottom + 34} textAnchor="end">
              n
            </text>
            <text className={classes.axis} x={MARGIN.left + inner.width / 2} y={HEIGHT_PX - 6} textAnchor="middle">
              {text.evaluation.distanceAxis}
            </text>
            {METHODS.map((method) => (
              <Line key={method} method={method} bins={bins} x={x} y={y} />
            ))}
          </svg>
        )}
      </div>
      <VisuallyHidden>
        <Numbers name={name} bins={bins} />
      </VisuallyHidden>
    </figure>
  );
}

function middleOf(bin: Bin): number {
  return (bin.start + bin.stop) / 2;
}

interface LineProps {
  method: Method;
  bins: Bin[];
  x: (metres: number) => number;
  y: (share: number) => number;
}

function Line({ method, bins, x, y }: LineProps) {
  const points = useMemo(
    () =>
      bins.map((bin) => {
        const share = bin.recall[method];
        return share === null ? null : { bin, share };
      }),
    [bins, method],
  );
  return (
    <g className={classes.series} data-method={method}>
      {runsOf(points).map((run) => (
        <polyline
          key={run[0]?.bin.start}
          className={classes.line}
          points={run.map(({ bin, share }) => `${x(middleOf(bin))},${y(share)}`).join(" ")}
        />
      ))}
      {points.map(
        (point) =>
          point && (
            <g key={point.bin.start}>
              <title>
                {text.evaluation.point(
                  text.evaluation.methods[method],
                  text.evaluation.distanceBin(point.bin.start, point.bin.stop),
                  percent(point.share),
                  point.bin.count,
                )}
              </title>
              <MarkShape method={method} x={x(middleOf(point.bin))} y={y(point.share)} />
            </g>
          ),
      )}
    </g>
  );
}

/** What the lines say, for who cannot see them. */
function Numbers({ name, bins }: { name: string; bins: Bin[] }) {
  return (
    <table>
      <caption>{name}</caption>
      <thead>
        <tr>
          <th scope="col">{text.evaluation.distanceAxis}</th>
          <th scope="col">{text.evaluation.distanceObjects}</th>
          {METHODS.map((method) => (
            <th key={method} scope="col">
              {text.evaluation.methods[method]}
            </th>
          ))}
        </tr>
      </thead>
      <tbody>
        {bins.map((bin) => (
          <tr key={bin.start}>
            <th scope="row">{text.evaluation.distanceBin(bin.start, bin.stop)}</th>
            <td>{count(bin.count)}</td>
            {METHODS.map((method) => (
              <td key={method}>{percent(bin.recall[method])}</td>
            ))}
          </tr>
        ))}
      </tbody>
    </table>
  );
}
