import { ActionIcon, Alert, Button, Group, Menu, Modal, Stack, Text, TextInput } from "@mantine/core";
import { IconChevronDown, IconSparkles } from "@tabler/icons-react";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api, messageOf, unwrap } from "../api/client";
import { modelsQuery } from "../api/queries";
import type { Drive } from "../api/types";
import { text } from "../strings";

/** Starts labelling: one click with the server's default model, or a choice of another. */
export function LabelButton({ drive }: { drive: Drive }) {
  const client = useQueryClient();
  const models = useQuery(modelsQuery).data ?? [];
  const [asking, setAsking] = useState(false);
  const [path, setPath] = useState("");
  const byDefault = models.find((model) => model.default);
  const label = useMutation({
    mutationFn: (modelPath: string | null) =>
      unwrap(
        api.POST("/api/drives/{drive_id}/label", {
          params: { path: { drive_id: drive.id } },
          body: { model_path: modelPath },
        }),
      ),
    onSuccess: async () => {
      setAsking(false);
      await Promise.all([
        client.invalidateQueries({ queryKey: ["drives"] }),
        client.invalidateQueries({ queryKey: ["drive", drive.id] }),
      ]);
    },
    // The sentence about what went wrong stands in the dialog, where another model can be chosen.
    onError: () => setAsking(true),
  });
  const words = drive.state === "new" ? text.drives.label : text.drives.labelAgain;

  return (
    <>
      <Group gap={1} wrap="nowrap">
        <Button
          size="xs"
          leftSection={<IconSparkles size={15} />}
          loading={label.isPending}
          style={{ borderStartEndRadius: 0, borderEndEndRadius: 0 }}
          onClick={() => (byDefault ? label.mutate(null) : setAsking(true))}
        >
          {words}
        </Button>
        <Menu position="bottom-end" withinPortal>
          <Menu.Target>
            <ActionIcon
              size={30}
              variant="filled"
              aria-label={text.drives.chooseModel}
              style={{ borderStartStartRadius: 0, borderEndStartRadius: 0 }}
            >
              <IconChevronDown size={15} />
            </ActionIcon>
          </Menu.Target>
          <Menu.Dropdown>
            <Menu.Label>{text.drives.chooseModel}</Menu.Label>
            {models.map((model) => (
              <Menu.Item key={model.path} onClick={() => label.mutate(model.path)}>
                {model.name}{" "}
                {model.default && (
                  <Text span size="xs" c="var(--muted)">
                    {text.drives.defaultModel}
                  </Text>
                )}
              </Menu.Item>
            ))}
            <Menu.Item onClick={() => setAsking(true)}>{text.drives.modelPath}</Menu.Item>
          </Menu.Dropdown>
        </Menu>
      </Group>
      <Modal
        opened={asking}
        onClose={() => {
          setAsking(false);
          label.reset();
        }}
        title={text.drives.modelPathTitle(drive.name)}
        centered
      >
        <form
          onSubmit={(event) => {
            event.preventDefault();
            if (path.trim()) label.mutate(path.trim());
          }}
        >
          <Stack>
            <TextInput
              data-autofocus
              label={text.drives.modelPathLabel}
              description={text.drives.modelPathHint}
              value={path}
              onChange={(event) => setPath(event.currentTarget.value)}
            />
            {label.error && (
              <Alert color="red" variant="outline" role="alert">
                {messageOf(label.error)}
              </Alert>
            )}
            <Group justify="flex-end">
              <Button type="submit" loading={label.isPending} disabled={!path.trim()}>
                {text.drives.label}
              </Button>
            </Group>
          </Stack>
        </form>
      </Modal>
    </>
  );
}
