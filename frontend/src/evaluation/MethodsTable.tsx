import { SegmentedControl, Table, Tooltip } from "@mantine/core";
import { useSearchParams } from "wouter";
import type { Evaluation } from "../api/types";
import pageClasses from "../app/DrivePage.module.css";
import { count, percent } from "../app/format";
import { text } from "../strings";
import classes from "./EvaluationPage.module.css";
import {
  type CameraGroup,
  type Choice,
  gain,
  iousOf,
  METHODS,
  readChoice,
  rowOf,
  type TruthKind,
  writeChoice,
} from "./figures";
import { MethodMark } from "./MethodMark";

const CAMERAS: CameraGroup[] = ["all", "front"];
const TRUTHS: TruthKind[] = ["whole", "visible"];

const COLUMNS = [
  { name: text.evaluation.precision, hint: text.evaluation.precisionHint },
  { name: text.evaluation.recall, hint: text.evaluation.recallHint },
  { name: text.evaluation.tp, hint: text.evaluation.tpHint },
  { name: text.evaluation.fp, hint: text.evaluation.fpHint },
  { name: text.evaluation.fn, hint: text.evaluation.fnHint },
];

/** The paper's table: three methods at each IoU. */
export function MethodsTable({ evaluation }: { evaluation: Evaluation }) {
  const [query, setQuery] = useSearchParams();
  const choice = readChoice(query);
  const choose = (change: Partial<Choice>) => setQuery(writeChoice({ ...choice, ...change }), { replace: true });
  const { rows } = evaluation;
  const ious = iousOf(rows);
  return (
    <section className={pageClasses.card} aria-labelledby="methods">
      <div className={classes.cardHead}>
        <h2 id="methods" className={classes.heading}>
          {text.evaluation.tableTitle}
        </h2>
        <div className={classes.switches}>
          <SegmentedControl
            size="xs"
            aria-label={text.evaluation.cameras}
            value={choice.cameras}
            onChange={(value) => choose({ cameras: value as CameraGroup })}
            data={CAMERAS.map((value) => ({ value, label: text.evaluation.cameraGroups[value] }))}
          />
          <SegmentedControl
            size="xs"
            aria-label={text.evaluation.truth}
            value={choice.truth}
            onChange={(value) => choose({ truth: value as TruthKind })}
            data={TRUTHS.map((value) => ({ value, label: text.evaluation.truthKinds[value] }))}
          />
        </div>
      </div>
      {rows.some((row) => row.cameras === choice.cameras && row.truth === choice.truth) ? (
        <Methods rows={rows} choice={choice} ious={ious} />
      ) : (
        <p className={classes.caption}>{text.evaluation.noRows}</p>
      )}
      <p className={classes.caption}>
        {text.evaluation.truthHints[choice.truth]} {text.evaluation.from[evaluation.without_tracking_from]}
      </p>
    </section>
  );
}

interface MethodsProps {
  rows: Evaluation["rows"];
  choice: Choice;
  ious: readonly number[];
}

function Methods({ rows, choice, ious }: MethodsProps) {
  const loosest = ious[0] ?? 0;
  const times = gain(rows, choice, loosest);
  return (
    <>
      <p className={classes.gain}>
        {times === null ? text.evaluation.noGain : text.evaluation.gain(times.toFixed(2), loosest)}
      </p>
      <Table.ScrollContainer minWidth={860} type="native">
        <Table className={classes.table} verticalSpacing={7} horizontalSpacing="sm">
          <Table.Thead>
            <Table.Tr>
              <Table.Th rowSpan={2} scope="col" className={classes.method}>
                {text.evaluation.method}
              </Table.Th>
              {ious.map((iou) => (
                <Table.Th key={iou} colSpan={COLUMNS.length} scope="colgroup" className={classes.group}>
                  <Hinted words={text.evaluation.atIou(iou)} hint={text.evaluation.iouHint} />
                </Table.Th>
              ))}
            </Table.Tr>
            <Table.Tr>
              {ious.flatMap((iou) =>
                COLUMNS.map(({ name, hint }, index) => (
                  <Table.Th key={`${iou} ${name}`} scope="col" data-first={index === 0 || undefined}>
                    <Hinted words={name} hint={hint} />
                  </Table.Th>
                )),
              )}
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {METHODS.map((method) => (
              <Table.Tr key={method} data-method={method}>
                <Table.Th scope="row" className={classes.method}>
                  <span className={classes.methodName}>
                    <MethodMark method={method} />
                    {text.evaluation.methods[method]}
                  </span>
                  <span className={classes.methodHint}>{text.evaluation.methodHints[method]}</span>
                </Table.Th>
                {ious.map((iou) => (
                  <Cells key={iou} row={rowOf(rows, choice, method, iou)} />
                ))}
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      </Table.ScrollContainer>
    </>
  );
}

function Cells({ row }: { row: Evaluation["rows"][number] | undefined }) {
  const counts = [row?.tp, row?.fp, row?.fn];
  return (
    <>
      <Table.Td data-first>{percent(row?.precision)}</Table.Td>
      <Table.Td data-recall>{percent(row?.recall)}</Table.Td>
      {counts.map((n, index) => (
        <Table.Td key={COLUMNS[index + 2]?.name}>{n === undefined ? percent(null) : count(n)}</Table.Td>
      ))}
    </>
  );
}

/** A word with its one sentence: for the pointer, and for who reads with the keyboard. */
function Hinted({ words, hint }: { words: string; hint: string }) {
  return (
    <Tooltip label={hint} multiline maw={280} openDelay={200} events={{ hover: true, focus: true, touch: true }}>
      <button type="button" className={classes.hinted} aria-label={`${words}: ${hint}`}>
        {words}
      </button>
    </Tooltip>
  );
}
