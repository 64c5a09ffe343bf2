import { Button, Loader, Progress, Skeleton } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { Link } from "wouter";
import { messageOf } from "../api/client";
import { factsQuery, histogramQuery, identitiesQuery, mergesQuery } from "../api/queries";
import type { DriveDetail, LabelHistogram } from "../api/types";
import { DrivePage, PageLoading } from "../app/DrivePage";
import pageClasses from "../app/DrivePage.module.css";
import { count } from "../app/format";
import { Notice } from "../app/Notice";
import { LabelButton } from "../drives/LabelButton";
import { CHECKS, isReviewed, NO_FILTER, writeFilter } from "../review/identities/filter";
import { text } from "../strings";
import { AuditTable } from "./AuditTable";
import { byClass, scores } from "./histogram";
import { Bars, PairedBars, SourceLegend } from "./Plots";
import classes from "./SummaryPage.module.css";
import { WhatIf } from "./WhatIf";

/** The labels of a drive in numbers, and how far their review is. */
export function SummaryPage({ driveId }: { driveId: number }) {
  return (
    <DrivePage driveId={driveId} title={(drive) => (drive ? text.summary.title(drive.name) : text.summary.name)}>
      {(drive) => <Content drive={drive} />}
    </DrivePage>
  );
}

function Content({ drive }: { drive: DriveDetail }) {
  const { data, error, refetch } = useQuery(histogramQuery(drive));
  const [threshold, setThreshold] = useState(0.5);
  if (data && data.count.length === 0) {
    return (
      <Notice title={text.evaluation.notLabelled}>
        <LabelButton drive={drive} />
      </Notice>
    );
  }
  if (error && !data) {
    return (
      <Notice title={text.summary.loadFailed} onRetry={() => void refetch()} role="alert">
        {messageOf(error)}
      </Notice>
    );
  }
  if (!data) return <PageLoading />;
  return (
    <>
      <header>
        <h1 className={pageClasses.title}>{text.summary.of(drive.name)}</h1>
        <p className={classes.quiet}>
          {text.summary.intro(drive.observation_count, drive.identity_count, drive.camera_names.length)}
        </p>
      </header>
      <div className={classes.cards}>
        <Card name={text.summary.progress}>
          <Reviewed drive={drive} />
        </Card>
        <Card name={text.summary.checksTitle}>
          <Checks drive={drive} />
        </Card>
        <Card name={text.summary.whatIf}>
          <WhatIf drive={drive} threshold={threshold} onChange={setThreshold} />
        </Card>
        <div className={classes.column}>
          <Card name={text.summary.classes}>
            <Bars
              rows={byClass(data).map((one) => ({ name: one.className, values: one.bySource }))}
              sources={data.sources}
            />
            <SourceLegend sources={data.sources} />
          </Card>
          <Scores histogram={data} />
          <Card name={text.summary.auditTitle}>
            <AuditTable drive={drive} />
          </Card>
        </div>
      </div>
    </>
  );
}

function Card({ name, children }: { name: string; children: React.ReactNode }) {
  return (
    <section className={`${pageClasses.card} ${classes.card}`} aria-label={name}>
      <h2>{name}</h2>
      {children}
    </section>
  );
}

function Scores({ histogram }: { histogram: LabelHistogram }) {
  const { before, after, undetected } = scores(histogram);
  return (
    <Card name={text.summary.scoresTitle}>
      <PairedBars
        names={before.map((_, tenth) => text.summary.scoreBin(tenth))}
        first={{ name: text.summary.beforeName, values: before }}
        second={{ name: text.summary.afterName, values: after }}
      />
      <p className={classes.quiet}>{text.summary.scoresCaption(undetected)}</p>
    </Card>
  );
}

/** How much of what waits for a person is answered. */
function Reviewed({ drive }: { drive: DriveDetail }) {
  const { data: merges } = useQuery(mergesQuery(drive.id));
  const { data: identities } = useQuery(identitiesQuery(drive.id));
  if (!merges || !identities) return <Skeleton h={110} />;
  const answered = merges.filter((merge) => merge.decided_by === "person").length;
  const all = answered + merges.filter((merge) => merge.state === "proposed").length;
  const reviewed = identities.filter(isReviewed).length;
  return (
    <>
      <Done words={text.summary.mergesAnswered(answered, all)} share={all === 0 ? 1 : answered / all} />
      <Done
        words={text.summary.identitiesReviewed(reviewed, identities.length)}
        share={identities.length === 0 ? 1 : reviewed / identities.length}
      />
      <Button component={Link} href={`/drives/${drive.id}?view=queue`} size="xs" variant="light" w="fit-content">
        {text.queue.name}
      </Button>
    </>
  );
}

function Done({ words, share }: { words: string; share: number }) {
  return (
    <div className={classes.done}>
      <span>{words}</span>
      <Progress value={100 * share} size="sm" aria-label={words} />
    </div>
  );
}

/** How many identities fail each check; each number leads to them. */
function Checks({ drive }: { drive: DriveDetail }) {
  const { data } = useQuery(factsQuery(drive));
  if (!data) return <Loader size="sm" role="img" aria-label={text.review.loading} />;
  return (
    <ul className={classes.checks}>
      {CHECKS.map((check) => {
        const failing = data.filter((one) => one.failed.some((failed) => failed.check === check)).length;
        const find = encodeURIComponent(writeFilter({ ...NO_FILTER, fails: check }));
        return (
          <li key={check}>
            <b>{text.summary.checks[check]}</b>
            {failing === 0 ? (
              <span>{count(0)}</span>
            ) : (
              <Link href={`/drives/${drive.id}?tab=identities&find=${find}`}>{text.summary.checksFailed(failing)}</Link>
            )}
            <span className={classes.quiet}>{text.summary.checkHints[check]}</span>
          </li>
        );
      })}
    </ul>
  );
}
