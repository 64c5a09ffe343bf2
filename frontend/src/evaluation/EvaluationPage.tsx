import { Button, Group, Loader, Skeleton, Stack, Text } from "@mantine/core";
import { IconChartLine, IconTargetOff } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import type { ReactNode } from "react";
import { Link } from "wouter";
import { ApiError, messageOf } from "../api/client";
import { evaluationQuery, isBusy } from "../api/queries";
import type { DriveDetail, Evaluation } from "../api/types";
import { DrivePage } from "../app/DrivePage";
import pageClasses from "../app/DrivePage.module.css";
import { Notice } from "../app/Notice";
import { JobProgress } from "../drives/JobProgress";
import { LabelButton } from "../drives/LabelButton";
import { text } from "../strings";
import { DistanceCharts } from "./DistanceCharts";
import classes from "./EvaluationPage.module.css";
import { Figures } from "./Figures";
import { MethodsTable } from "./MethodsTable";

/** How good a drive's labels are: the paper's table, recall by distance, and how well identities hold. */
export function EvaluationPage({ driveId }: { driveId: number }) {
  return (
    <DrivePage
      driveId={driveId}
      title={(drive) => (drive ? text.evaluation.title(drive.name) : text.evaluation.name)}
      className={classes.page}
    >
      {(drive) => <Content drive={drive} />}
    </DrivePage>
  );
}

/** The figures, or why there are none and what to do about it. */
function Content({ drive }: { drive: DriveDetail }) {
  const labelled = drive.state === "ready";
  const { data, error, refetch } = useQuery({ ...evaluationQuery(drive), enabled: labelled });
  if (isBusy(drive)) {
    return (
      <State title={text.evaluation.labelling} hint={text.evaluation.labellingHint}>
        <JobProgress drive={drive} />
      </State>
    );
  }
  if (!labelled) {
    return (
      <State title={text.evaluation.notLabelled} hint={drive.error ?? text.evaluation.notLabelledHint}>
        <LabelButton drive={drive} />
      </State>
    );
  }
  if (error instanceof ApiError && error.code === "no_truth") {
    return (
      <State
        title={text.evaluation.noTruth}
        hint={text.evaluation.noTruthHint(drive.name)}
        icon={<IconTargetOff size={34} stroke={1.3} />}
      >
        <Button component={Link} href={`/drives/${drive.id}`} variant="default" size="xs">
          {text.evaluation.goToReview}
        </Button>
      </State>
    );
  }
  if (data) return <Compared drive={drive} evaluation={data} />;
  if (error) {
    return (
      <Notice title={text.evaluation.failed} onRetry={() => void refetch()} role="alert">
        {messageOf(error)}
      </Notice>
    );
  }
  return <Comparing />;
}

function Compared({ drive, evaluation }: { drive: DriveDetail; evaluation: Evaluation }) {
  const { confidence, max_distance_m, truth_count, dont_care_count } = evaluation;
  return (
    <>
      <header className={classes.head}>
        <h1 className={pageClasses.title}>{text.evaluation.of(drive.name)}</h1>
        <p className={classes.intro}>
          {text.evaluation.settings(confidence, max_distance_m, truth_count, dont_care_count)}{" "}
          {text.evaluation.classes[evaluation.classes]}
        </p>
      </header>
      <MethodsTable evaluation={evaluation} />
      <DistanceCharts rows={evaluation.by_distance} />
      <Figures tracking={evaluation.tracking} merges={evaluation.merges} />
    </>
  );
}

function Comparing() {
  return (
    <>
      <div className={classes.comparing} role="status">
        <Loader size="sm" />
        <div>
          <Text fw={600}>{text.evaluation.loading}</Text>
          <Text size="sm" c="var(--muted)">
            {text.evaluation.loadingHint}
          </Text>
        </div>
      </div>
      <Skeleton h={210} radius={12} />
      <Skeleton h={320} radius={12} />
    </>
  );
}

interface StateProps {
  title: string;
  hint: string;
  icon?: ReactNode;
  children: ReactNode;
}

function State({ title, hint, icon = <IconChartLine size={34} stroke={1.3} />, children }: StateProps) {
  return (
    <Stack align="center" justify="center" flex={1} gap="sm" p="xl" ta="center" role="status">
      {icon}
      <h1 className={pageClasses.title}>{title}</h1>
      <Text size="sm" c="var(--muted)" maw={480} style={{ textWrap: "balance" }}>
        {hint}
      </Text>
      <Group mt="xs">{children}</Group>
    </Stack>
  );
}
