import { Menu, Text } from "@mantine/core";
import { IconCheck } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { modelsQuery } from "../api/queries";
import type { Drive } from "../api/types";
import { text } from "../strings";

interface ModelItemsProps {
  drive: Drive;
  onChoose: (model: string) => void;
  onNamePath: () => void;
}

/** Entries of a menu: every model that the server offers, with where it comes from and what to know about it. */
export function ModelItems({ drive, onChoose, onNamePath }: ModelItemsProps) {
  const models = useQuery(modelsQuery).data ?? [];
  return (
    <>
      {models.map((model) => (
        <Menu.Item
          key={model.named}
          maw={360}
          leftSection={
            <IconCheck size={15} style={{ visibility: model.name === drive.model ? undefined : "hidden" }} />
          }
          onClick={() => onChoose(model.named)}
        >
          {model.name}{" "}
          <Text span size="xs" c="var(--muted)">
            {[text.drives.origins[model.origin], ...(model.default ? [text.drives.defaultModel] : [])].join(", ")}
          </Text>
          {model.notice && !drive.is_simulated && (
            <Text size="xs" c="var(--muted)">
              {model.notice}
            </Text>
          )}
        </Menu.Item>
      ))}
      <Menu.Item leftSection={<span style={{ width: 15 }} />} onClick={onNamePath}>
        {text.drives.modelPath}
      </Menu.Item>
    </>
  );
}
