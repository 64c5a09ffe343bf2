/** Live progress of a job by server-sent events. */

import { useEffect } from "react";
import { api } from "./client";
import type { Job } from "./types";

const FINAL: ReadonlySet<Job["state"]> = new Set(["done", "failed", "cancelled"]);

export function isFinal(job: Job): boolean {
  return FINAL.has(job.state);
}

/**
 * Calls `onJob` on each change of a job. Returns the function that stops it.
 *
 * The stream ends after a final state; the browser would connect again by itself, so it is closed here.
 */
export function watchJob(jobId: number, onJob: (job: Job) => void): () => void {
  const source = new EventSource(`/api/jobs/${jobId}/events`);
  source.addEventListener("job", (event) => {
    const job = JSON.parse((event as MessageEvent<string>).data) as Job;
    onJob(job);
    if (isFinal(job)) source.close();
  });
  // The browser connects again by itself; whether the server still answers is asked apart, so that the page can say so.
  source.onerror = () => void api.GET("/api/health").catch(() => undefined);
  return () => source.close();
}

/** `watchJob` for as long as a component shows the job. `null` watches nothing. `onJob` must be stable. */
export function useJobEvents(jobId: number | null, onJob: (job: Job) => void): void {
  useEffect(() => (jobId === null ? undefined : watchJob(jobId, onJob)), [jobId, onJob]);
}
