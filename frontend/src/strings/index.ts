/** Every English sentence of the page, in one folder: a file for each part of the page. */

import { app, coach } from "./app";
import { drives } from "./drives";
import { edits } from "./edits";
import { evaluation } from "./evaluation";
import { find, identities } from "./identities";
import { keys } from "./keys";
import { merges, queue } from "./merges";
import { cameras, exports, review, scene, timeline } from "./review";
import { summary } from "./summary";

export const text = {
  app,
  drives,
  review,
  cameras,
  timeline,
  merges,
  queue,
  identities,
  scene,
  evaluation,
  find,
  summary,
  edits,
  exports,
  coach,
  keys,
} as const;
