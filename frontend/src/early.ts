/**
 * What the page of a drive needs is asked for first of all: its code and the drive, side by side.
 *
 * This module is to be imported before all others, so that it runs before they are set up.
 */

import { driveQuery, queryClient } from "./api/queries";

const drive = /^\/drives\/(\d+)$/.exec(window.location.pathname)?.[1];
if (drive !== undefined) {
  void import("./review/ReviewPage"); // a failure is told by whoever needs it
  void queryClient.prefetchQuery(driveQuery(Number(drive)));
}
