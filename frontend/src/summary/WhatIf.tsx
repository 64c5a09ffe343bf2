import { NumberInput, Slider } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useMemo } from "react";
import { ApiError, messageOf } from "../api/client";
import { evaluationQuery, histogramQuery } from "../api/queries";
import type { DriveDetail } from "../api/types";
import { count, percent } from "../app/format";
import { typedNumber } from "../app/typedNumber";
import { text } from "../strings";
import { DistanceBars } from "./DistanceBars";
import { qualityAt, ThresholdCounts } from "./histogram";
import { SourceLegend } from "./Plots";
import classes from "./WhatIf.module.css";

interface WhatIfProps {
  drive: DriveDetail;
  threshold: number;
  onChange: (threshold: number) => void;
}

const IOU = 0.5;

/** What a threshold leaves of the labels, at once: how many, how far, and with truth how right and how complete. */
export function WhatIf({ drive, threshold, onChange }: WhatIfProps) {
  const { data, error } = useQuery(histogramQuery(drive));
  const counts = useMemo(() => (data ? new ThresholdCounts(data) : null), [data]);
  const most = useMemo(() => {
    if (!counts) return 0;
    return Math.max(...counts.at(0).byDistance.map((bin) => bin.bySource.reduce((sum, n) => sum + n, 0)));
  }, [counts]);
  const shown = counts?.at(threshold);
  return (
    <div className={classes.whatIf}>
      <div className={classes.choice}>
        <span id="min-score">{text.exports.minScore}</span>
        <NumberInput
          size="xs"
          w={76}
          aria-labelledby="min-score"
          min={0}
          max={1}
          step={0.05}
          decimalScale={2}
          fixedDecimalScale
          value={threshold}
          onChange={(value) => onChange(typedNumber(value) ?? threshold)}
        />
      </div>
      <Slider
        min={0}
        max={1}
        step={0.01}
        value={threshold}
        onChange={onChange}
        label={null}
        thumbLabel={text.exports.minScore}
      />
      {error && !data && <p className={classes.quiet}>{messageOf(error)}</p>}
      {shown && counts && (
        <>
          <dl className={classes.figures}>
            <div>
              <dt>{text.summary.exported}</dt>
              <dd>{count(shown.total)}</dd>
            </div>
            <div>
              <dt>{text.summary.before}</dt>
              <dd>{count(shown.before)}</dd>
            </div>
            <Quality drive={drive} threshold={threshold} />
          </dl>
          <DistanceBars bins={shown.byDistance} sources={counts.sources} most={most} />
          <SourceLegend sources={counts.sources} />
        </>
      )}
    </div>
  );
}

/** Precision and recall at the threshold, where the drive has truth; nothing where it has none. */
function Quality({ drive, threshold }: { drive: DriveDetail; threshold: number }) {
  const { data, error, isPending } = useQuery(evaluationQuery(drive));
  if (error instanceof ApiError && error.code === "no_truth") return null;
  const curve = data?.curves.find((one) => one.method === "multi-camera" && one.iou === IOU);
  const quality = qualityAt(curve, threshold);
  return (
    <>
      <div title={text.evaluation.precisionHint}>
        <dt>{text.evaluation.precision}</dt>
        <dd>{isPending ? "…" : percent(quality?.precision)}</dd>
      </div>
      <div title={text.evaluation.recallHint}>
        <dt>{text.evaluation.recall}</dt>
        <dd>{isPending ? "…" : percent(quality?.recall)}</dd>
      </div>
    </>
  );
}
