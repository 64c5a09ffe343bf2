import { Group, Loader, Text } from "@mantine/core";
import { useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { api } from "../api/client";
import { useConnection } from "../api/connection";
import { text } from "../strings";
import classes from "./ConnectionBanner.module.css";

const RETRY_MS = 2_000;

/** Says that the server does not answer, asks it every two seconds, and refreshes what is shown once it is back. */
export function ConnectionBanner() {
  const lost = useConnection((state) => state.lost);
  const client = useQueryClient();

  useEffect(() => {
    if (!lost) return;
    const timer = setInterval(() => void api.GET("/api/health").catch(() => undefined), RETRY_MS);
    return () => {
      clearInterval(timer);
      void client.invalidateQueries();
    };
  }, [lost, client]);

  if (!lost) return null;
  return (
    <Group className={classes.banner} role="alert" justify="center" gap="sm">
      <Loader size={14} color="white" />
      <Text size="sm" fw={600}>
        {text.app.connectionLost}
      </Text>
      <Text size="sm">{text.app.connectionRetry}</Text>
    </Group>
  );
}
