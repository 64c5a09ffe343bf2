import { text } from "../../strings";
import classes from "./Legend.module.css";

/** The signs of the boxes, drawn as they are drawn on the pictures. */
export function Legend() {
  return (
    <ul className={classes.legend} aria-label={text.cameras.legend}>
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
    </ul>
  );
}
