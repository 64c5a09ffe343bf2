import { ActionIcon, Button, Center, Loader, Text, Tooltip } from "@mantine/core";
import { IconChartLine, IconCube3dSphere, IconGitMerge, IconHistory, IconKeyboard } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { lazy, Suspense, useCallback, useDeferredValue, useEffect, useState, useSyncExternalStore } from "react";
import { Link } from "wouter";
import { messageOf } from "../api/client";
import { driveQuery } from "../api/queries";
import type { DriveDetail, MergeState } from "../api/types";
import { Header } from "../app/Header";
import { Notice } from "../app/Notice";
import { Splitter } from "../app/Splitter";
import { useStoredState } from "../app/storedState";
import { JobProgress } from "../drives/JobProgress";
import { LabelButton } from "../drives/LabelButton";
import { text } from "../strings";
import { Coach } from "./Coach";
import { CameraGrid } from "./cameras/CameraGrid";
import { DrawBar } from "./edits/DrawBar";
import { EditNoticeBar } from "./edits/EditNoticeBar";
import { useDriveEvents } from "./edits/useDriveEvents";
import { useEditKeys } from "./edits/useEditKeys";
import { Key, withKey } from "./keys/Key";
import { KeyHelp } from "./keys/KeyHelp";
import { useKeys } from "./keys/useKeys";
import { ReviewProvider, useReview, useShared } from "./ReviewContext";
import classes from "./ReviewPage.module.css";
import { SidePanel } from "./SidePanel";
import { SceneView } from "./scene/SceneView";
import { Timeline } from "./timeline/Timeline";
import { usePlayback } from "./timeline/usePlayback";

const QueueView = lazy(() => import("./queue/QueueView").then((module) => ({ default: module.QueueView })));

/** One drive: the pictures, what the machine says about them, and the decisions. */
export function ReviewPage({ driveId }: { driveId: number }) {
  const { data, error, refetch } = useQuery(driveQuery(driveId));
  if (data) {
    return (
      <ReviewProvider drive={data}>
        <Review drive={data} />
      </ReviewProvider>
    );
  }
  return (
    <div className={classes.page}>
      <Header />
      {error ? (
        <Notice title={text.review.loadFailed} onRetry={() => void refetch()} role="alert">
          {messageOf(error)}
          <br />
          <Link href="/">{text.app.backToDrives}</Link>
        </Notice>
      ) : (
        <Center flex={1}>
          <Loader role="img" aria-label={text.review.loading} />
        </Center>
      )}
    </div>
  );
}

const LogDrawer = lazy(() => import("./edits/LogDrawer").then((module) => ({ default: module.LogDrawer })));

const PANEL = { min: 330, max: 900 };
const SCENE = { min: 140, max: 1200 };

/** A part of the window to begin with, within limits (px). */
function share(ofPx: number, part: number, min: number, max: number): number {
  return Math.round(Math.min(max, Math.max(min, ofPx * part)));
}

function Review({ drive }: { drive: DriveDetail }) {
  const [panelWidth, setPanelWidth] = useStoredState("panelWidth", share(window.innerWidth, 0.25, 390, 560));
  const [sceneHeight, setSceneHeight] = useStoredState("sceneHeight", share(window.innerHeight, 0.3, 190, 480));
  const [sceneOpen, setSceneOpen] = useStoredState("sceneOpen", true as boolean);
  const [helpOpen, setHelpOpen] = useState(false);
  const [mergesShown, setMergesShown] = useState<MergeState>("proposed");
  const showMerges = useCallback((state: MergeState) => setMergesShown(state), []);
  const { store } = useShared();
  const view = useReview((state) => state.view);
  const whole = useWhole();
  usePlayback();
  useEffect(() => {
    document.title = `${drive.name} · ${text.app.name}`;
  }, [drive.name]);
  const [logOpen, setLogOpen] = useState(false);
  useDriveEvents();
  useKeys({
    mergesShown,
    toggleScene: () => setSceneOpen(!sceneOpen),
    openHelp: () => setHelpOpen(true),
  });
  useEditKeys(() => setLogOpen(true)); // after the page's own: while boxes are drawn, Esc ends that

  return (
    <div className={classes.page}>
      <Header
        actions={
          <Actions
            drive={drive}
            sceneOpen={sceneOpen}
            onScene={() => setSceneOpen(!sceneOpen)}
            onHelp={() => setHelpOpen(true)}
            onLog={() => setLogOpen(true)}
          />
        }
      >
        <h1 className={classes.name}>{drive.name}</h1>
        {drive.state === "ready" && (
          <Text size="sm" c="var(--muted)">
            {text.drives.proposals(drive.proposed_merge_count)}
          </Text>
        )}
        {drive.warnings.length > 0 && (
          <Tooltip label={drive.warnings.join(" ")} multiline maw={420}>
            <Text size="sm" c="var(--warning)" tabIndex={0}>
              {text.review.warnings(drive.warnings.length)}
            </Text>
          </Tooltip>
        )}
      </Header>
      <Unlabelled drive={drive} />
      {drive.state === "ready" && <Coach />}
      {view === "queue" ? (
        <Suspense fallback={<div className={classes.body} />}>
          <QueueView onClose={() => store.getState().setView("cameras")} />
        </Suspense>
      ) : (
        <div className={classes.body}>
          <main className={classes.main}>
            <DrawBar />
            <CameraGrid />
            <Timeline whole={whole} />
          </main>
          <aside className={classes.side} style={{ width: panelWidth }}>
            <Splitter
              orientation="vertical"
              label={text.review.resizePanel}
              size={panelWidth}
              {...PANEL}
              onChange={setPanelWidth}
            />
            <div className={classes.panels}>
              {whole ? (
                <SidePanel width={panelWidth} mergesShown={mergesShown} onShowMerges={showMerges} />
              ) : (
                <div className={classes.waiting} />
              )}
              {sceneOpen && (
                <>
                  <Splitter
                    orientation="horizontal"
                    label={text.scene.resize}
                    size={sceneHeight}
                    {...SCENE}
                    onChange={setSceneHeight}
                  />
                  {whole ? (
                    <SceneView height={sceneHeight} onClose={() => setSceneOpen(false)} />
                  ) : (
                    <div style={{ height: sceneHeight }} />
                  )}
                </>
              )}
            </div>
          </aside>
        </div>
      )}
      <EditNoticeBar />
      <Suspense fallback={null}>{logOpen && <LogDrawer opened onClose={() => setLogOpen(false)} />}</Suspense>
      <KeyHelp opened={helpOpen} onClose={() => setHelpOpen(false)} />
    </div>
  );
}

const FIRST_FRAME_MS = 2_000;

/**
 * Whether to make the parts around the cameras: pictures come first, and what takes longer to make and to load after
 * them, or when they keep a person waiting.
 */
function useWhole(): boolean {
  const { frames } = useShared();
  const shown = useSyncExternalStore(frames.subscribe, () => frames.committed() !== null);
  const [late, setLate] = useState(false);
  useEffect(() => {
    const timer = setTimeout(() => setLate(true), FIRST_FRAME_MS);
    return () => clearTimeout(timer);
  }, []);
  return useDeferredValue(shown || late, false);
}

interface ActionsProps {
  drive: DriveDetail;
  sceneOpen: boolean;
  onScene: () => void;
  onHelp: () => void;
  onLog: () => void;
}

function Actions({ drive, sceneOpen, onScene, onHelp, onLog }: ActionsProps) {
  return (
    <>
      {drive.state === "ready" && <QueueButton />}
      {drive.state === "ready" && (
        <Button component={Link} href={`/drives/${drive.id}/summary`} size="xs" variant="default">
          {text.summary.name}
        </Button>
      )}
      {drive.state === "ready" && (
        <Button
          component={Link}
          href={`/drives/${drive.id}/evaluation`}
          size="xs"
          variant="default"
          leftSection={<IconChartLine size={16} />}
        >
          {text.evaluation.name}
        </Button>
      )}
      <Button
        size="xs"
        variant={sceneOpen ? "light" : "default"}
        aria-pressed={sceneOpen}
        leftSection={<IconCube3dSphere size={16} />}
        rightSection={<Key action="toggleScene" />}
        onClick={onScene}
      >
        {text.scene.view}
      </Button>
      <Tooltip label={withKey(text.edits.showLog, "log")}>
        <ActionIcon variant="subtle" color="gray" aria-label={text.edits.showLog} onClick={onLog}>
          <IconHistory size={19} />
        </ActionIcon>
      </Tooltip>
      <Tooltip label={withKey(text.review.showKeys, "help")}>
        <ActionIcon variant="subtle" color="gray" aria-label={text.review.showKeys} onClick={onHelp}>
          <IconKeyboard size={19} />
        </ActionIcon>
      </Tooltip>
    </>
  );
}

/** The way into the merge queue, and out of it. */
function QueueButton() {
  const { store } = useShared();
  const open = useReview((state) => state.view === "queue");
  return (
    <Button
      size="xs"
      variant={open ? "light" : "default"}
      aria-pressed={open}
      leftSection={<IconGitMerge size={16} />}
      rightSection={<Key action="queue" />}
      onClick={() => store.getState().setView(open ? "cameras" : "queue")}
    >
      {text.queue.name}
    </Button>
  );
}

/** Says why there are no boxes yet, and what to do about it. */
function Unlabelled({ drive }: { drive: DriveDetail }) {
  if (drive.state === "ready") return null;
  const busy = drive.state === "queued" || drive.state === "labelling";
  return (
    <div className={classes.unlabelled} role="status">
      <Text size="sm">
        {busy ? text.review.labellingNow : drive.state === "failed" ? text.review.failed : text.review.notLabelled}{" "}
        {drive.error}
      </Text>
      {busy ? <JobProgress drive={drive} /> : <LabelButton drive={drive} />}
    </div>
  );
}
