import { ActionIcon, Alert, Button, Group, Menu, Modal, Stack, Text } from "@mantine/core";
import { IconAlertTriangle, IconChartLine, IconDots, IconTrash } from "@tabler/icons-react";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { Link } from "wouter";
import { api, messageOf, unwrap } from "../api/client";
import { imageUrl } from "../api/imageUrl";
import { isBusy } from "../api/queries";
import type { Drive } from "../api/types";
import { duration } from "../app/format";
import { placeOf } from "../review/cameras/layout";
import { text } from "../strings";
import classes from "./DriveCard.module.css";
import { JobProgress } from "./JobProgress";
import { LabelButton } from "./LabelButton";
import { ModelItems } from "./ModelItems";
import { ModelPath } from "./ModelPath";
import { useLabelling, useModelOf } from "./useLabelling";

/** One drive of the list: what it looks like, how far it is, and the next thing to do with it. */
export function DriveCard({ drive }: { drive: Drive }) {
  const [removing, setRemoving] = useState(false);
  const [asking, setAsking] = useState(false);
  const labelling = useLabelling(drive);
  const model = useModelOf(drive);
  const href = `/drives/${drive.id}`;
  return (
    <li className={classes.card}>
      <Link href={href} className={classes.picture} tabIndex={-1} aria-hidden>
        <Preview drive={drive} />
      </Link>
      <div className={classes.words}>
        <div className={classes.title}>
          <Link href={href} className={classes.name}>
            {drive.name}
          </Link>
          <span className={classes.state} data-state={drive.state}>
            {text.drives.states[drive.state]}
          </span>
        </div>
        <Text size="sm" c="var(--muted)">
          {[...facts(drive), ...(model.name ? [text.drives.withModel(drive.state, model.name)] : [])].join(" · ")}
        </Text>
        {drive.state === "ready" && (
          <Text size="sm">
            {text.drives.identities(drive.identity_count)} · <b>{text.drives.proposals(drive.proposed_merge_count)}</b>
          </Text>
        )}
        {model.notice && (
          <Text size="xs" c="var(--muted)" className={classes.notice}>
            <IconAlertTriangle size={14} /> {model.notice}
          </Text>
        )}
        {drive.error && (
          <Text size="sm" c="var(--danger)" role="alert" className={classes.error}>
            {drive.error}
          </Text>
        )}
      </div>
      <Group gap="xs" wrap="nowrap" className={classes.actions}>
        {isBusy(drive) ? <JobProgress drive={drive} /> : drive.state !== "ready" && <LabelButton drive={drive} />}
        {!isBusy(drive) && (
          <Button
            component={Link}
            href={href}
            size="xs"
            variant={drive.state === "ready" ? "filled" : "default"}
            aria-label={drive.state === "ready" ? text.drives.reviewOf(drive.name) : text.drives.lookAt(drive.name)}
          >
            {drive.state === "ready" ? text.drives.review : text.drives.look}
          </Button>
        )}
        <Menu position="bottom-end">
          <Menu.Target>
            <ActionIcon variant="subtle" color="gray" aria-label={text.drives.more(drive.name)}>
              <IconDots size={18} />
            </ActionIcon>
          </Menu.Target>
          <Menu.Dropdown>
            {drive.state === "ready" && (
              <Menu.Item component={Link} href={`${href}/evaluation`} leftSection={<IconChartLine size={15} />}>
                {text.evaluation.name}
              </Menu.Item>
            )}
            {drive.state === "ready" && (
              <>
                <Menu.Divider />
                <Menu.Label>{text.drives.labelAgainWith}</Menu.Label>
                <ModelItems
                  drive={drive}
                  onChoose={(named) => labelling.mutate(named, { onError: () => setAsking(true) })}
                  onNamePath={() => setAsking(true)}
                />
                <Menu.Divider />
              </>
            )}
            <Menu.Item c="var(--danger)" leftSection={<IconTrash size={15} />} onClick={() => setRemoving(true)}>
              {text.drives.remove}
            </Menu.Item>
          </Menu.Dropdown>
        </Menu>
      </Group>
      <ModelPath drive={drive} labelling={labelling} opened={asking} onClose={() => setAsking(false)} />
      <Remove drive={drive} opened={removing} onClose={() => setRemoving(false)} />
    </li>
  );
}

function facts(drive: Drive): string[] {
  return [
    text.drives.formats[drive.format] ?? drive.format,
    text.drives.cameras(drive.camera_names.length),
    drive.has_lidar ? text.drives.lidar : text.drives.noLidar,
    text.drives.frames(drive.frame_count),
    duration(drive.duration_ms),
    ...(drive.uploaded ? [text.drives.uploaded] : []),
  ];
}

/** The view ahead in the middle of the drive. */
function Preview({ drive }: { drive: Drive }) {
  const [broken, setBroken] = useState(false);
  const ahead = drive.camera_names.find((camera) => {
    const place = placeOf(camera);
    return place?.row === "front" && place.column === "centre";
  });
  const camera = ahead ?? drive.camera_names[0];
  if (!camera || broken) return null;
  return (
    <img
      src={imageUrl(drive.id, Math.floor(drive.frame_count / 2), camera, 480)}
      alt=""
      loading="lazy"
      onError={() => setBroken(true)}
    />
  );
}

function Remove({ drive, opened, onClose }: { drive: Drive; opened: boolean; onClose: () => void }) {
  const client = useQueryClient();
  const remove = useMutation({
    mutationFn: () => unwrap(api.DELETE("/api/drives/{drive_id}", { params: { path: { drive_id: drive.id } } })),
    onSuccess: async () => {
      onClose();
      await client.invalidateQueries({ queryKey: ["drives"] });
    },
  });
  return (
    <Modal opened={opened} onClose={onClose} title={text.drives.removeTitle(drive.name)} centered>
      <Stack>
        <Text size="sm">{drive.uploaded ? text.drives.removeUploaded : text.drives.removeFolder}</Text>
        {remove.error && (
          <Alert color="red" variant="outline" role="alert">
            {messageOf(remove.error)}
          </Alert>
        )}
        <Group justify="flex-end">
          <Button variant="default" onClick={onClose} data-autofocus>
            {text.app.cancel}
          </Button>
          <Button color="red" loading={remove.isPending} onClick={() => remove.mutate()}>
            {text.drives.remove}
          </Button>
        </Group>
      </Stack>
    </Modal>
  );
}
