import { useQuery } from "@tanstack/react-query";
import { auditQuery } from "../api/queries";
import type { AuditBin, DriveDetail } from "../api/types";
import { count, percent } from "../app/format";
import { text } from "../strings";
import classes from "./AuditTable.module.css";

type Agreement = AuditBin["box"];

/** How often hidden boxes and their classes came back, in all and by distance, or by height where that is not known. */
export function AuditTable({ drive }: { drive: DriveDetail }) {
  const { data } = useQuery(auditQuery(drive.id));
  if (data === undefined) return null;
  if (data === null) {
    return (
      <p className={classes.quiet}>
        {text.summary.auditNone} <code>hindsight audit</code>
      </p>
    );
  }
  const [rows, unit] =
    data.by_distance.length > 0 ? [data.by_distance, "m"] : [data.by_height, text.summary.auditHeight];
  return (
    <>
      <p className={classes.quiet}>{text.summary.audited(data.hidden, data.confident, data.confidence)}</p>
      <table className={classes.table}>
        <thead>
          <tr>
            <td />
            <th scope="col">{text.summary.auditHidden}</th>
            <th scope="col">{text.summary.auditBox}</th>
            <th scope="col">{text.summary.auditLabel}</th>
          </tr>
        </thead>
        <tbody>
          <Row name={text.summary.auditAll} box={data.box} label={data.label} />
          {rows.map((row) => (
            <Row key={row.start} name={rangeOf(row, unit)} box={row.box} label={row.label} />
          ))}
        </tbody>
      </table>
      <p className={classes.quiet}>{text.summary.auditCaption}</p>
    </>
  );
}

function rangeOf({ start, stop }: AuditBin, unit: string): string {
  return stop === null ? text.summary.auditFrom(start, unit) : text.summary.auditBetween(start, stop, unit);
}

function Row({ name, box, label }: { name: string; box: Agreement; label: Agreement }) {
  return (
    <tr>
      <th scope="row">{name}</th>
      <td>{count(box.of)}</td>
      <Share of={box} />
      <Share of={label} />
    </tr>
  );
}

/** A share as a bar with its interval, and as a number. */
function Share({ of }: { of: Agreement }) {
  if (of.share === null || of.low === null || of.high === null) return <td>{percent(null)}</td>;
  return (
    <td title={text.summary.auditInterval(percent(of.low), percent(of.high))}>
      <span className={classes.bar} aria-hidden>
        <span style={{ width: `${100 * of.share}%` }} />
        <i style={{ left: `${100 * of.low}%`, width: `${100 * (of.high - of.low)}%` }} />
      </span>
      {percent(of.share)}
    </td>
  );
}
