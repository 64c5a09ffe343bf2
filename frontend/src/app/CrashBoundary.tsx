import { Button, Center, Code, Stack, Text } from "@mantine/core";
import { Component, type ReactNode } from "react";
import { text } from "../strings";

/** Shows a fault of the page as a sentence with a way out, instead of a white screen. */
export class CrashBoundary extends Component<{ children: ReactNode }, { fault: Error | null }> {
  override state: { fault: Error | null } = { fault: null };

  static getDerivedStateFromError(fault: Error) {
    return { fault };
  }

  override render() {
    if (!this.state.fault) return this.props.children;
    return (
      <Center h="100%" p="xl">
        <Stack align="center" role="alert">
          <Text>{text.app.crashed}</Text>
          <Code>{this.state.fault.message}</Code>
          <Button onClick={() => window.location.reload()}>{text.app.reload}</Button>
        </Stack>
      </Center>
    );
  }
}
