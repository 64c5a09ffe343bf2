import type { Merge, MergeLooks } from "../../api/types";
import { score } from "../../app/format";
import { text } from "../../strings";
import classes from "./Evidence.module.css";
import { chance, facts } from "./evidenceWords";

/** How likely it is, what speaks for it, and what depends on it. */
export function Evidence({ merge, sides }: { merge: Merge; sides: MergeLooks["sides"] }) {
  const { value, meaning } = chance(merge.probability);
  const [a, b] = sides;
  const donor = (a.best.score ?? 0) >= (b.best.score ?? 0) ? a : b;
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
      <dl className={classes.facts}>
        {facts(merge).map((fact) => (
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
    </div>
  );
}
