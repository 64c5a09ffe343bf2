import type { Evaluation } from "../api/types";
import pageClasses from "../app/DrivePage.module.css";
import { count, percent } from "../app/format";
import { text } from "../strings";
import classes from "./EvaluationPage.module.css";

interface FiguresProps {
  tracking: Evaluation["tracking"];
  merges: Evaluation["merges"];
}

/** How well identities hold, and how the merges across cameras stand against the truth. */
export function Figures({ tracking, merges }: FiguresProps) {
  return (
    <div className={classes.pair}>
      <section className={pageClasses.card} aria-labelledby="identities">
        <h2 id="identities" className={classes.heading}>
          {text.evaluation.identitiesTitle}
        </h2>
        <dl className={classes.figures}>
          <Figure name={text.evaluation.hota} value={percent(tracking.hota)} hint={text.evaluation.hotaHint} />
          <Figure name={text.evaluation.idf1} value={percent(tracking.idf1)} hint={text.evaluation.idf1Hint} />
          <Figure
            name={text.evaluation.idSwitches}
            value={count(tracking.id_switches)}
            hint={text.evaluation.idSwitchesHint}
          />
        </dl>
      </section>
      <section className={pageClasses.card} aria-labelledby="merges">
        <h2 id="merges" className={classes.heading}>
          {text.evaluation.mergesTitle}
        </h2>
        <dl className={classes.figures}>
          <Figure
            name={text.evaluation.mergesRight}
            value={count(merges.right)}
            hint={text.evaluation.mergesRightHint}
          />
          <Figure
            name={text.evaluation.mergesWrong}
            value={count(merges.wrong)}
            hint={text.evaluation.mergesWrongHint}
          />
          <Figure
            name={text.evaluation.mergesMissed}
            value={count(merges.missed)}
            hint={text.evaluation.mergesMissedHint}
          />
        </dl>
      </section>
    </div>
  );
}

function Figure({ name, value, hint }: { name: string; value: string; hint: string }) {
  return (
    <div className={classes.figure}>
      <dt>{name}</dt>
      <dd className={classes.value}>{value}</dd>
      <dd className={classes.hint}>{hint}</dd>
    </div>
  );
}
