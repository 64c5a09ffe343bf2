import { useMemo } from "react";
import { text } from "../../strings";
import { useCommitted } from "../ReviewContext";
import { useAppearance } from "./appearance";
import { type Colouring, classColour, PROVENANCES, type Provenance, SCORE_STEPS } from "./colouring";
import classes from "./Legend.module.css";

/** The signs and colours of the boxes, drawn as they are drawn on the pictures. */
export function Legend() {
  const colouring = useAppearance((state) => state.colouring);
  return (
    <ul className={classes.legend} aria-label={text.cameras.legend}>
      <Colours colouring={colouring} />
      <li>
        <span className={classes.own}>car</span>
        {text.cameras.legendAuto}
      </li>
      <li>
        <span className={classes.propagated}>→ car</span>
        {text.cameras.legendPropagated}
      </li>
      <li>
        <span className={classes.filled} />
        {text.cameras.legendFilled}
      </li>
      <li>
        <span className={classes.faded} />
        {text.cameras.legendFaded}
      </li>
    </ul>
  );
}

function Colours({ colouring }: { colouring: Colouring }) {
  const committed = useCommitted();
  const classNames = useMemo(
    () =>
      colouring === "class"
        ? [...new Set(committed?.observations.map((one) => one.label.class_name) ?? [])].sort()
        : [],
    [colouring, committed?.observations],
  );
  if (colouring === "score") {
    return (
      <li className={classes.ramp}>
        {SCORE_STEPS.map(({ from, colour }) => (
          <span key={from} className={classes.step} style={{ background: colour }}>
            {from.toFixed(2)}
          </span>
        ))}
      </li>
    );
  }
  const swatches: [string, string][] =
    colouring === "provenance"
      ? (Object.entries(PROVENANCES) as [Provenance, string][]).map(([name, colour]) => [
          text.cameras.provenances[name],
          colour,
        ])
      : classNames.map((name) => [name, classColour(name)]);
  return swatches.map(([words, colour]) => (
    <li key={words}>
      <span className={classes.swatch} style={{ background: colour }} />
      {words}
    </li>
  ));
}
