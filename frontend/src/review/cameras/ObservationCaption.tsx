import type { Observation } from "../../api/types";
import { score } from "../../app/format";
import { text } from "../../strings";
import classes from "./ObservationCaption.module.css";
import { identityColour } from "./palette";

/** What is known of the box under the pointer, in a corner of its picture where it covers nothing that is pointed at. */
export function ObservationCaption({ observation }: { observation: Observation }) {
  const { label } = observation;
  return (
    <div className={classes.caption}>
      <span className={classes.swatch} style={{ background: identityColour(observation.identity_id) }} />
      <strong>
        #{observation.identity_id} {label.class_name} {score(label.score)}
      </strong>
      <span>{origin(observation)}</span>
      {label.source === "propagated" && (
        <span>
          {observation.score === null
            ? text.cameras.notDetected
            : text.cameras.detectorSaid(observation.class_name, score(observation.score))}
        </span>
      )}
      {observation.filled && <span>{text.cameras.filledIn}</span>}
    </div>
  );
}

function origin({ label }: Observation): string {
  if (label.source === "human") return text.cameras.humanLabel;
  if (label.source === "auto") return text.cameras.ownLabel;
  if (!label.donor) return text.cameras.legendPropagated;
  return text.cameras.propagatedFrom(label.donor.camera, label.donor.frame_index, score(label.donor.score));
}
