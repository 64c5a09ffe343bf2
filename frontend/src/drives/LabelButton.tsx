import { ActionIcon, Button, Group, Menu } from "@mantine/core";
import { IconChevronDown, IconSparkles } from "@tabler/icons-react";
import { useState } from "react";
import type { Drive } from "../api/types";
import { text } from "../strings";
import { ModelItems } from "./ModelItems";
import { ModelPath } from "./ModelPath";
import { useLabelling } from "./useLabelling";

/** Starts labelling: one click with the server's default model, or a choice of another. */
export function LabelButton({ drive }: { drive: Drive }) {
  const [asking, setAsking] = useState(false);
  const labelling = useLabelling(drive);
  const start = (model: string | null) => labelling.mutate(model, { onError: () => setAsking(true) });
  const words = drive.state === "new" ? text.drives.label : text.drives.labelAgain;

  return (
    <>
      <Group gap={1} wrap="nowrap">
        <Button
          size="xs"
          leftSection={<IconSparkles size={15} />}
          loading={labelling.isPending}
          style={{ borderStartEndRadius: 0, borderEndEndRadius: 0 }}
          onClick={() => start(null)}
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
            <ModelItems drive={drive} onChoose={start} onNamePath={() => setAsking(true)} />
          </Menu.Dropdown>
        </Menu>
      </Group>
      <ModelPath drive={drive} labelling={labelling} opened={asking} onClose={() => setAsking(false)} />
    </>
  );
}
