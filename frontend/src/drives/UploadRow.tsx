import { ActionIcon, Progress, Text, Tooltip } from "@mantine/core";
import { IconX } from "@tabler/icons-react";
import { bytes, duration } from "../app/format";
import { text } from "../strings";
import classes from "./UploadRow.module.css";
import { type RunningUpload, useUploads } from "./uploads";

const RATE_AFTER_MS = 1_500;

/** One upload: how far it is, how long it takes, and a way to stop it. */
export function UploadRow({ upload }: { upload: RunningUpload }) {
  const dismiss = useUploads((state) => state.dismiss);
  const failed = upload.state === "failed";
  const label = failed ? text.drives.dismissUpload(upload.fileName) : text.drives.cancelUpload(upload.fileName);
  return (
    <div className={classes.upload} data-failed={failed || undefined}>
      <div className={classes.main}>
        <div className={classes.words}>
          <Text size="sm" fw={600}>
            {upload.fileName}
          </Text>
          <Text size="xs" c={failed ? "var(--danger)" : "var(--muted)"} role={failed ? "alert" : undefined}>
            {failed ? upload.error : progressWords(upload)}
          </Text>
        </div>
        {!failed && (
          <Progress
            size="sm"
            value={(100 * upload.loaded) / Math.max(1, upload.total)}
            animated={upload.state === "unpacking"}
            aria-label={upload.fileName}
          />
        )}
      </div>
      <Tooltip label={label}>
        <ActionIcon
          variant="subtle"
          color="gray"
          aria-label={label}
          onClick={() => (failed ? dismiss(upload.id) : upload.cancel())}
        >
          <IconX size={16} />
        </ActionIcon>
      </Tooltip>
    </div>
  );
}

function progressWords(upload: RunningUpload): string {
  if (upload.state === "unpacking") return text.drives.unpacking;
  const sent = text.drives.uploading(bytes(upload.loaded), bytes(upload.total));
  const elapsedMs = performance.now() - upload.startedAtMs;
  if (elapsedMs < RATE_AFTER_MS || upload.loaded === 0) return sent;
  const perMs = upload.loaded / elapsedMs;
  return `${sent}, ${text.drives.uploadRate(bytes(perMs * 1000), duration((upload.total - upload.loaded) / perMs))}`;
}
