import { Button, Stack, Text } from "@mantine/core";
import type { ReactNode } from "react";
import { text } from "../strings";

interface NoticeProps {
  icon?: ReactNode;
  title: string;
  children?: ReactNode;
  onRetry?: (() => void) | undefined;
  role?: "alert" | "status";
}

/** What stands where there is nothing to show: why, and what to do. */
export function Notice({ icon, title, children, onRetry, role = "status" }: NoticeProps) {
  return (
    <Stack align="center" justify="center" gap={6} p="xl" h="100%" ta="center" role={role}>
      {icon}
      <Text fw={600} fz={15} maw={420}>
        {title}
      </Text>
      {children && (
        <Text size="sm" c="var(--muted)" maw={380} style={{ textWrap: "balance" }}>
          {children}
        </Text>
      )}
      {onRetry && (
        <Button size="xs" mt="xs" variant="default" onClick={onRetry}>
          {text.app.retry}
        </Button>
      )}
    </Stack>
  );
}
