import { Alert, Button, Group, Modal, Stack, TextInput } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api, messageOf, unwrap } from "../api/client";
import { text } from "../strings";

/** Opens a drive that already lies on the server's disk. */
export function OpenFolder({ opened, onClose }: { opened: boolean; onClose: () => void }) {
  const client = useQueryClient();
  const [path, setPath] = useState("");
  const [scene, setScene] = useState("");
  const open = useMutation({
    mutationFn: () =>
      unwrap(
        api.POST("/api/drives", { body: { path: path.trim(), scene: scene.trim() === "" ? null : scene.trim() } }),
      ),
    onSuccess: async () => {
      await client.invalidateQueries({ queryKey: ["drives"] });
      setPath("");
      setScene("");
      onClose();
    },
  });
  return (
    <Modal
      opened={opened}
      onClose={() => {
        open.reset();
        onClose();
      }}
      title={text.drives.folderTitle}
      size="lg"
      centered
    >
      <form
        onSubmit={(event) => {
          event.preventDefault();
          if (path.trim()) open.mutate();
        }}
      >
        <Stack>
          <TextInput
            data-autofocus
            label={text.drives.folderLabel}
            description={text.drives.folderHint}
            placeholder="/data/drives/2026-11-03"
            value={path}
            onChange={(event) => setPath(event.currentTarget.value)}
          />
          <TextInput
            label={text.drives.sceneLabel}
            value={scene}
            onChange={(event) => setScene(event.currentTarget.value)}
          />
          {open.error && (
            <Alert color="red" variant="outline" role="alert">
              {messageOf(open.error)}
            </Alert>
          )}
          <Group justify="flex-end">
            <Button variant="default" onClick={onClose}>
              {text.app.cancel}
            </Button>
            <Button type="submit" loading={open.isPending} disabled={!path.trim()}>
              {text.drives.open}
            </Button>
          </Group>
        </Stack>
      </form>
    </Modal>
  );
}
