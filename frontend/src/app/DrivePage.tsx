import { Button, Center, Loader, Text } from "@mantine/core";
import { IconPhoto } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { type ReactNode, useEffect } from "react";
import { Link } from "wouter";
import { messageOf } from "../api/client";
import { driveQuery } from "../api/queries";
import type { DriveDetail } from "../api/types";
import { text } from "../strings";
import classes from "./DrivePage.module.css";
import { Header } from "./Header";
import { Notice } from "./Notice";

interface DrivePageProps {
  driveId: number;
  /** What stands in the tab, of the drive once it is known. */
  title: (drive: DriveDetail | undefined) => string;
  className?: string | undefined;
  children: (drive: DriveDetail) => ReactNode;
}

/** A page that tells something of a drive: its name above, the way to its review, and what there is to read. */
export function DrivePage({ driveId, title, className, children }: DrivePageProps) {
  const { data: drive, error, refetch } = useQuery(driveQuery(driveId));
  const name = title(drive);
  useEffect(() => {
    document.title = `${name} · ${text.app.name}`;
  }, [name]);
  return (
    <div className={[classes.page, className].filter(Boolean).join(" ")}>
      <Header
        actions={
          drive && (
            <Button
              component={Link}
              href={`/drives/${driveId}`}
              size="xs"
              variant="default"
              leftSection={<IconPhoto size={16} />}
              aria-label={text.drives.reviewOf(drive.name)}
            >
              {text.drives.review}
            </Button>
          )
        }
      >
        {drive && (
          <Text size="sm" fw={560} truncate>
            {drive.name}
          </Text>
        )}
      </Header>
      <main className={classes.main}>
        {drive && children(drive)}
        {!drive && error && (
          <Notice title={text.review.loadFailed} onRetry={() => void refetch()} role="alert">
            {messageOf(error)}
            <br />
            <Link href="/">{text.app.backToDrives}</Link>
          </Notice>
        )}
        {!drive && !error && <PageLoading />}
      </main>
    </div>
  );
}

export function PageLoading() {
  return (
    <Center flex={1}>
      <Loader role="img" aria-label={text.review.loading} />
    </Center>
  );
}
