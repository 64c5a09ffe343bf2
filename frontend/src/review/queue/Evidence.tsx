import type { Merge, MergeLooks } from "../../api/types";
import { score } from "../../app/format";
import { text } from "../../strings";
import classes from "./Evidence.module.css";
import { chance, type Fact, facts, measures } from "./evidenceWords";

/** Of what a probability is made of, this much is shown at once. */
const MOST_MEASURES = 5;

/** How likely it is, what speaks for it, and what depends on it. */
export function Evidence({ merge, sides }: { merge: Merge; sides: MergeLooks["sides"] }) {
  const { value, meaning } = chance(merge);
  const [a, b] = sides;
  const donor = (a.best.score ?? 0) >= (b.best.score ?? 0) ? a : b;
  const made = measures(merge);
  const shown = made.length > 0 ? made : facts(merge);
  const rest = shown.slice(MOST_MEASURES);
  return (
    <div className={classes.evidence}>
      <div className={classes.heads}>
        <div className={classes.head}>
          <span className={classes.large}>{value}</span>
          <span className={classes.quiet}>{meaning}</span>
        </div>
        <div className={classes.head}>
          <span className={classes.large}>{text.queue.changes(merge.label_count)}</span>
          <span className={classes.quiet}>
            {merge.label_count === 0
              ? text.queue.nothingDepends
              : text.queue.depends(donor.best.class_name, score(donor.best.score), donor.camera)}
          </span>
        </div>
      </div>
      <Facts facts={shown.slice(0, MOST_MEASURES)} />
      {rest.length > 0 && (
        <details className={classes.more}>
          <summary>{text.queue.moreMeasures(rest.length)}</summary>
          <Facts facts={rest} />
        </details>
      )}
    </div>
  );
}

function Facts({ facts: list }: { facts: readonly Fact[] }) {
  return (
    <dl className={classes.facts}>
      {list.map((fact) => (
        <div key={fact.name} data-speaks={fact.speaks}>
          <dt>{fact.name}</dt>
          <dd className={classes.value}>{fact.value}</dd>
          <dd className={classes.meaning}>
            <span className={classes.mark} aria-hidden>
              {fact.speaks > 0 ? "+" : fact.speaks < 0 ? "−" : "·"}
            </span>
            {fact.meaning}
          </dd>
        </div>
      ))}
    </dl>
  );
}
