import { Alert, Button, Group, Modal, Stack, TextInput } from "@mantine/core";
import { useState } from "react";
import { messageOf } from "../api/client";
import type { Drive } from "../api/types";
import { text } from "../strings";
import type { useLabelling } from "./useLabelling";

interface ModelPathProps {
  drive: Drive;
  labelling: ReturnType<typeof useLabelling>;
  opened: boolean;
  onClose: () => void;
}

/** Asks for a model by its file; also where the sentence stands about what went wrong with another one. */
export function ModelPath({ drive, labelling, opened, onClose }: ModelPathProps) {
  const [path, setPath] = useState("");
  return (
    <Modal
      opened={opened}
      onClose={() => {
        onClose();
        labelling.reset();
      }}
      title={text.drives.modelPathTitle(drive.name)}
      centered
    >
      <form
        onSubmit={(event) => {
          event.preventDefault();
          if (path.trim()) labelling.mutate(path.trim(), { onSuccess: onClose });
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
          {labelling.error && (
            <Alert color="red" variant="outline" role="alert">
              {messageOf(labelling.error)}
            </Alert>
          )}
          <Group justify="flex-end">
            <Button type="submit" loading={labelling.isPending} disabled={!path.trim()}>
              {text.drives.label}
            </Button>
          </Group>
        </Stack>
      </form>
    </Modal>
  );
}
