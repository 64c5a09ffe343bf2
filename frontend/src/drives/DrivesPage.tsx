import { Button, FileButton, Group, Skeleton, Text } from "@mantine/core";
import { IconFolderOpen, IconRoad, IconUpload } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { type DragEvent, useEffect, useState } from "react";
import { messageOf } from "../api/client";
import { drivesQuery } from "../api/queries";
import { Header } from "../app/Header";
import { Notice } from "../app/Notice";
import { text } from "../strings";
import { DriveCard } from "./DriveCard";
import classes from "./DrivesPage.module.css";
import { OpenFolder } from "./OpenFolder";
import { UploadRow } from "./UploadRow";
import { useUploads } from "./uploads";

/** All drives, and the ways to add one. */
export function DrivesPage() {
  const { data, error, refetch } = useQuery(drivesQuery);
  const { list: uploads, start } = useUploads();
  const [opening, setOpening] = useState(false);
  const drop = useDrop((files) => files.forEach(start));
  const sending = uploads.some((upload) => upload.state !== "failed");

  useEffect(() => {
    document.title = `${text.drives.title} · ${text.app.name}`;
  }, []);
  useEffect(() => {
    if (!sending) return;
    const ask = (event: BeforeUnloadEvent) => event.preventDefault();
    window.addEventListener("beforeunload", ask);
    return () => window.removeEventListener("beforeunload", ask);
  }, [sending]);

  const empty = data?.length === 0 && uploads.length === 0;
  const add = (
    <Group gap="xs">
      <Button variant="default" leftSection={<IconFolderOpen size={16} />} onClick={() => setOpening(true)}>
        {text.drives.openFolder}
      </Button>
      <FileButton onChange={(files) => files.forEach(start)} accept=".zip,.tar,.gz,.tgz" multiple>
        {(props) => (
          <Button {...props} leftSection={<IconUpload size={16} />}>
            {text.drives.upload}
          </Button>
        )}
      </FileButton>
    </Group>
  );

  return (
    <div className={classes.page} {...drop.handlers}>
      <Header />
      <main className={classes.main}>
        {empty ? (
          <section className={classes.first}>
            <IconRoad size={40} stroke={1.2} />
            <h1 className={classes.title}>{text.drives.emptyTitle}</h1>
            <Text maw={560}>{text.drives.intro}</Text>
            {add}
            <Text size="sm" c="var(--muted)">
              {text.drives.emptyHint}
            </Text>
          </section>
        ) : (
          <>
            <header className={classes.head}>
              <h1 className={classes.title}>{text.drives.title}</h1>
              {add}
            </header>
            {uploads.map((upload) => (
              <UploadRow key={upload.id} upload={upload} />
            ))}
            {error && !data && (
              <Notice title={text.drives.loadFailed} onRetry={() => void refetch()} role="alert">
                {messageOf(error)}
              </Notice>
            )}
            {!data && !error && [0, 1, 2].map((row) => <Skeleton key={row} h={134} radius={12} />)}
            <ul className={classes.list}>
              {data?.map((drive) => (
                <DriveCard key={drive.id} drive={drive} />
              ))}
            </ul>
          </>
        )}
      </main>
      {drop.over && (
        <div className={classes.drop}>
          <IconUpload size={36} stroke={1.4} />
          {text.drives.dropHere}
        </div>
      )}
      <OpenFolder opened={opening} onClose={() => setOpening(false)} />
    </div>
  );
}

/** Files dropped anywhere on the page. */
function useDrop(onFiles: (files: File[]) => void) {
  const [depth, setDepth] = useState(0);
  const holdsFiles = (event: DragEvent) => event.dataTransfer.types.includes("Files");
  return {
    over: depth > 0,
    handlers: {
      onDragEnter: (event: DragEvent) => holdsFiles(event) && setDepth((n) => n + 1),
      onDragLeave: (event: DragEvent) => holdsFiles(event) && setDepth((n) => Math.max(0, n - 1)),
      onDragOver: (event: DragEvent) => event.preventDefault(),
      onDrop: (event: DragEvent) => {
        event.preventDefault();
        setDepth(0);
        onFiles([...event.dataTransfer.files]);
      },
    },
  };
}
