import { Alert, Button, Group, Paper, Progress, Stack, Text } from "@mantine/core";
import { IconDownload, IconFileExport } from "@tabler/icons-react";
import { useMutation, useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { create } from "zustand";
import { api, messageOf, unwrap } from "../../api/client";
import { bytes, count, score } from "../../app/format";
import { text } from "../../strings";
import { WhatIf } from "../../summary/WhatIf";
import { useShared } from "../ReviewContext";
import classes from "./ExportPanel.module.css";

interface Started {
  exportId: number;
  driveId: number;
  minScore: number;
}

/** Exports started on this visit, the latest first: they go on while another tab is open. */
const useStarted = create<{ list: Started[]; add: (one: Started) => void }>()((set) => ({
  list: [],
  add: (one) => set(({ list }) => ({ list: [one, ...list] })),
}));

const POLL_MS = 1_000;

/** From labels to a dataset file. */
export function ExportPanel() {
  const { driveId, drive } = useShared();
  const [minScore, setMinScore] = useState(0);
  const { list, add } = useStarted();
  const start = useMutation({
    mutationFn: () =>
      unwrap(
        api.POST("/api/drives/{drive_id}/exports", {
          params: { path: { drive_id: driveId } },
          body: { format: "coco", min_score: minScore },
        }),
      ),
    onSuccess: (made) => add({ exportId: made.id, driveId, minScore }),
  });

  return (
    <Stack className={classes.panel} gap="md">
      <Text size="sm" c="var(--muted)">
        {text.exports.intro}
      </Text>
      {drive.proposed_merge_count > 0 && (
        <Text size="sm">{text.exports.proposalsLeft(drive.proposed_merge_count)}</Text>
      )}
      <WhatIf drive={drive} threshold={minScore} onChange={setMinScore} />
      <Text size="xs" c="var(--muted)">
        {text.exports.minScoreHint}
      </Text>
      <Button
        leftSection={<IconFileExport size={16} />}
        loading={start.isPending}
        disabled={drive.observation_count === 0}
        onClick={() => start.mutate()}
      >
        {text.exports.start} {text.exports.coco}
      </Button>
      {start.error && (
        <Alert color="red" variant="outline" title={text.exports.failed} role="alert">
          {messageOf(start.error)}
        </Alert>
      )}
      {list
        .filter((one) => one.driveId === driveId)
        .map((one) => (
          <StartedExport key={one.exportId} started={one} />
        ))}
    </Stack>
  );
}

function StartedExport({ started }: { started: Started }) {
  const { data, error } = useQuery({
    queryKey: ["export", started.exportId],
    queryFn: ({ signal }) =>
      unwrap(api.GET("/api/exports/{export_id}", { params: { path: { export_id: started.exportId } }, signal })),
    refetchInterval: (query) =>
      query.state.data?.state === "done" || query.state.data?.state === "failed" ? false : POLL_MS,
  });
  const why = data?.error ?? (error ? messageOf(error) : null);
  return (
    <Paper withBorder p="sm" bg="var(--surface-raised)">
      <Group justify="space-between" wrap="nowrap">
        <div>
          <Text size="sm" fw={600}>
            COCO, {text.exports.madeWith(score(started.minScore))}
          </Text>
          <Text size="xs" c="var(--muted)" role="status">
            {data?.state === "done"
              ? text.exports.done(count(data.label_count ?? 0), bytes(data.size_bytes ?? 0))
              : (why ?? text.exports.running)}
          </Text>
        </div>
        {data?.file_url && (
          <Button component="a" href={data.file_url} download size="xs" leftSection={<IconDownload size={15} />}>
            {text.exports.download}
          </Button>
        )}
      </Group>
      {!why && data?.state !== "done" && (
        <Progress mt={8} size="sm" value={100} animated aria-label={text.exports.running} />
      )}
    </Paper>
  );
}
