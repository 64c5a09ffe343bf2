import { ActionIcon, Progress, Text, Tooltip } from "@mantine/core";
import { IconPlayerStop } from "@tabler/icons-react";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useCallback } from "react";
import { api, messageOf, unwrap } from "../api/client";
import { isFinal, useJobEvents } from "../api/jobEvents";
import { driveQuery, drivesQuery } from "../api/queries";
import type { Drive, Job } from "../api/types";
import { count } from "../app/format";
import { text } from "../strings";
import classes from "./JobProgress.module.css";

/**
 * Live progress of a drive's label job, with a way to stop it.
 *
 * Only a running job is listened to: a browser keeps six connections to a server, and drives that wait need none.
 */
export function JobProgress({ drive }: { drive: Drive }) {
  const client = useQueryClient();
  const { id, job } = drive;
  const onJob = useCallback(
    (next: Job) => {
      client.setQueryData(drivesQuery.queryKey, (all) =>
        all?.map((one) => (one.id === id ? { ...one, job: next } : one)),
      );
      client.setQueryData(driveQuery(id).queryKey, (one) => one && { ...one, job: next });
      if (isFinal(next)) {
        void client.invalidateQueries({ queryKey: ["drives"] });
        void client.invalidateQueries({ queryKey: ["drive", id] });
      }
    },
    [client, id],
  );
  useJobEvents(job?.state === "running" ? job.id : null, onJob);
  const stop = useMutation({
    mutationFn: (jobId: number) =>
      unwrap(api.POST("/api/jobs/{job_id}/cancel", { params: { path: { job_id: jobId } } })),
    onSuccess: onJob,
  });

  const running = job?.state === "running";
  const part = running && job.total > 0 ? (100 * job.done) / job.total : 0;
  const stage = running && job.stage ? (text.drives.stages[job.stage] ?? job.stage) : text.drives.waiting;
  return (
    <div className={classes.progress}>
      <div className={classes.bar}>
        <Text size="xs" className={classes.words} c={stop.error ? "var(--danger)" : undefined}>
          <span>{stop.error ? messageOf(stop.error) : stage}</span>
          {running && job.total > 0 && (
            <span className={classes.numbers}>
              {count(job.done)} / {count(job.total)}
            </span>
          )}
        </Text>
        <Progress
          value={running ? part : 100}
          animated={!running}
          color={running ? undefined : "gray"}
          size="sm"
          aria-label={stage}
        />
      </div>
      {job && !isFinal(job) && (
        <Tooltip label={text.drives.stopJob}>
          <ActionIcon
            variant="subtle"
            color="gray"
            aria-label={text.drives.stopJob}
            loading={stop.isPending}
            onClick={() => stop.mutate(job.id)}
          >
            <IconPlayerStop size={16} />
          </ActionIcon>
        </Tooltip>
      )}
    </div>
  );
}
