/** A decision in words, for the log and for what was just done. */

import type { Edit } from "../../api/types";
import { text } from "../../strings";

function objects(ids: readonly number[]): string {
  if (ids.length === 0) return text.edits.newObject;
  return ids.length <= 3 ? ids.map((id) => `#${id}`).join(", ") : text.edits.objects(ids.length);
}

export function describeEdit(edit: Edit): string {
  const says = text.edits.says;
  const who = objects(edit.identity_ids);
  const frame = (edit.frame_index ?? 0) + 1;
  switch (edit.action) {
    case "class":
      return says.class(who, edit.class_name ?? "");
    case "split":
      return says.split(edit.track_ids.map((id) => `${id}`).join(", "), frame);
    case "swap":
      return says.swap(who, frame);
    case "box":
      return says.box(who, edit.camera ?? "", frame);
    case "interpolate":
      return says.interpolate(who, frame, (edit.until_frame ?? 0) + 1);
    case "donor":
      return edit.frame_index == null
        ? says.donorTrack(who, edit.camera ?? "")
        : says.donor(who, edit.camera ?? "", frame);
    case "mark":
      return says.mark[edit.mark ?? "open"](who);
    case "comment":
      return says.comment(who, edit.text ?? "");
    case "accept":
    case "reject":
    case "unsure":
    case "undo":
      return says.merge[edit.action](edit.track_ids.join(text.edits.and));
    case "undo_edit":
    case "redo_edit":
      return says[edit.action](edit.target_id ?? 0);
    case "delete":
      return edit.frame_index == null ? says.delete(who) : says.deleteBox(who, frame);
    default:
      return says.join(who);
  }
}
