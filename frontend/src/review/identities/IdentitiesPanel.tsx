import { Progress, Select, Skeleton, Stack, Text } from "@mantine/core";
import { IconAlertTriangle, IconStack2 } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { useVirtualizer } from "@tanstack/react-virtual";
import { useEffect, useMemo, useRef } from "react";
import { messageOf } from "../../api/client";
import { factsQuery, identitiesQuery } from "../../api/queries";
import type { Identity, IdentityFacts } from "../../api/types";
import { score } from "../../app/format";
import { Notice } from "../../app/Notice";
import { text } from "../../strings";
import { identityColour } from "../cameras/palette";
import { MarkIcon } from "../edits/MarkIcon";
import { useReview, useShared } from "../ReviewContext";
import rowClasses from "../rows.module.css";
import { FilterBar } from "./FilterBar";
import { isReviewed, matches } from "./filter";
import classes from "./IdentitiesPanel.module.css";
import { useIdentityList } from "./identityList";
import { type FactsById, type IdentitySort, sortIdentities } from "./sort";

const ROW_PX = 46;

/** All identities of the drive, however many. */
export function IdentitiesPanel() {
  const { driveId, store } = useShared();
  const { data, error, refetch, isPending } = useQuery(identitiesQuery(driveId));
  const identityIds = useReview((state) => state.identityIds);
  const filter = useReview((state) => state.filter);
  const sort = useReview((state) => state.sort);
  const setOrder = useIdentityList((state) => state.setOrder);
  const facts = useFacts();
  const scroller = useRef<HTMLDivElement>(null);
  const list = useMemo(() => {
    const found = (data ?? []).filter((one) => matches(filter, one, facts.get(one.id)));
    return sortIdentities(found, sort, facts);
  }, [data, sort, filter, facts]);
  const classNames = useMemo(() => [...new Set((data ?? []).map((one) => one.class_name))].sort(), [data]);

  useEffect(() => setOrder(list.map((one) => one.id)), [list, setOrder]);

  const rows = useVirtualizer({
    count: list.length,
    getScrollElement: () => scroller.current,
    estimateSize: () => ROW_PX,
    overscan: 8,
  });
  const selectedAt = list.findIndex((one) => one.id === identityIds[0]);
  useEffect(() => {
    if (selectedAt >= 0) rows.scrollToIndex(selectedAt, { align: "auto" });
  }, [selectedAt, rows]);

  if (error && !data) {
    return (
      <Notice title={text.identities.loadFailed} onRetry={() => void refetch()} role="alert">
        {messageOf(error)}
      </Notice>
    );
  }
  if (isPending) {
    return (
      <Stack p="sm" gap={6}>
        {[0, 1, 2, 3, 4, 5].map((row) => (
          <Skeleton key={row} h={ROW_PX - 6} />
        ))}
      </Stack>
    );
  }
  if (data.length === 0)
    return (
      <Notice icon={<IconStack2 size={28} stroke={1.4} />} title={text.identities.none}>
        {text.identities.noneHint}
      </Notice>
    );

  const hover = (identity: Identity | null) =>
    store.getState().setHover(identity && { identityId: identity.id, observationId: null });

  return (
    <div className={rowClasses.panel}>
      <ReviewProgress identities={data} />
      <FilterBar classNames={classNames} />
      <div className={classes.tools}>
        <Select
          size="xs"
          aria-label={text.identities.sort}
          allowDeselect={false}
          value={sort}
          onChange={(value) => value && store.getState().setSort(value as IdentitySort)}
          data={Object.entries(text.identities.sorts).map(([value, label]) => ({ value, label }))}
        />
        <Text size="xs" c="var(--muted)" className={classes.count}>
          {text.identities.count(list.length)}
        </Text>
      </div>
      {list.length === 0 && <Notice title={text.find.none}>{text.find.noneHint}</Notice>}
      <div ref={scroller} className={rowClasses.scroller}>
        <ul className={rowClasses.list} style={{ height: rows.getTotalSize() }}>
          {rows.getVirtualItems().map((row) => {
            const identity = list[row.index];
            return (
              identity && (
                <li
                  key={identity.id}
                  className={`${rowClasses.row} ${classes.row}`}
                  style={{ transform: `translateY(${row.start}px)`, height: ROW_PX }}
                >
                  <button
                    type="button"
                    className={rowClasses.choice}
                    aria-pressed={identityIds.includes(identity.id)}
                    onClick={(event) => {
                      const adds = event.ctrlKey || event.metaKey || event.shiftKey;
                      if (adds) store.getState().toggle(identity.id);
                      else store.getState().select([identity.id]);
                    }}
                    onDoubleClick={() => store.getState().setTab("selected")}
                    onPointerEnter={() => hover(identity)}
                    onPointerLeave={() => hover(null)}
                  >
                    <IdentityRow identity={identity} failed={facts.get(identity.id)?.failed ?? []} />
                  </button>
                </li>
              )
            );
          })}
        </ul>
      </div>
    </div>
  );
}

const NO_FACTS: FactsById = new Map();

/** Distances and failed checks by identity; none until they are worked out. */
function useFacts(): FactsById {
  const { drive } = useShared();
  const { data } = useQuery(factsQuery(drive));
  return useMemo(() => (data ? new Map(data.map((one) => [one.identity_id, one])) : NO_FACTS), [data]);
}

/** How many identities a person has looked at; a bar, as there are many. */
function ReviewProgress({ identities }: { identities: readonly Identity[] }) {
  const reviewed = identities.filter(isReviewed).length;
  const said = text.summary.identitiesReviewed(reviewed, identities.length);
  return (
    <div className={classes.progress}>
      <Progress size="sm" flex={1} value={(100 * reviewed) / identities.length} aria-label={said} />
      <span className={rowClasses.quiet}>{said}</span>
    </div>
  );
}

interface IdentityRowProps {
  identity: Identity;
  failed: IdentityFacts["failed"];
}

function IdentityRow({ identity, failed }: IdentityRowProps) {
  return (
    <>
      <span className={classes.swatch} style={{ background: identityColour(identity.id) }} />
      <span className={classes.main}>
        <span className={classes.title}>
          #{identity.id} {identity.class_name}
          <MarkIcon identity={identity} />
        </span>
        <span className={rowClasses.quiet}>
          {failed.length > 0 && (
            <span className={classes.failed}>
              <IconAlertTriangle size={12} aria-hidden />{" "}
              {failed.map((one) => text.summary.checks[one.check]).join(", ")} ·{" "}
            </span>
          )}
          {identity.camera_names.join(", ")}
        </span>
      </span>
      <span className={classes.numbers}>
        <span className={classes.score}>{score(identity.score)}</span>
        <span className={rowClasses.quiet}>
          {text.identities.observations(identity.observation_count)},{" "}
          {text.identities.propagated(identity.propagated_count)}
        </span>
      </span>
    </>
  );
}
