import { Select, Skeleton, Stack, Text } from "@mantine/core";
import { IconStack2 } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { useVirtualizer } from "@tanstack/react-virtual";
import { useEffect, useMemo, useRef } from "react";
import { messageOf } from "../../api/client";
import { identitiesQuery } from "../../api/queries";
import type { Identity } from "../../api/types";
import { score } from "../../app/format";
import { Notice } from "../../app/Notice";
import { text } from "../../strings";
import { identityColour } from "../cameras/palette";
import { useReview, useShared } from "../ReviewContext";
import classes from "./IdentitiesPanel.module.css";
import { useIdentityList } from "./identityList";
import { type IdentitySort, sortIdentities } from "./sort";

const ROW_PX = 46;

/** All identities of the drive, however many. */
export function IdentitiesPanel() {
  const { driveId, store } = useShared();
  const { data, error, refetch, isPending } = useQuery(identitiesQuery(driveId));
  const identityIds = useReview((state) => state.identityIds);
  const { sort, className, setSort, setClassName, setOrder } = useIdentityList();
  const scroller = useRef<HTMLDivElement>(null);
  const list = useMemo(() => sortIdentities(data ?? [], sort, className), [data, sort, className]);
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
    <div className={classes.panel}>
      <div className={classes.tools}>
        <Select
          size="xs"
          aria-label={text.identities.sort}
          allowDeselect={false}
          value={sort}
          onChange={(value) => value && setSort(value as IdentitySort)}
          data={Object.entries(text.identities.sorts).map(([value, label]) => ({ value, label }))}
        />
        <Select
          size="xs"
          aria-label={text.identities.filterLabel}
          placeholder={text.identities.classFilter}
          clearable
          value={className}
          onChange={setClassName}
          data={classNames}
        />
        <Text size="xs" c="var(--muted)" className={classes.count}>
          {text.identities.count(list.length)}
        </Text>
      </div>
      {list.length === 0 && <Notice title={text.identities.noneOfClass} />}
      <div ref={scroller} className={classes.scroller}>
        <ul className={classes.list} style={{ height: rows.getTotalSize() }}>
          {rows.getVirtualItems().map((row) => {
            const identity = list[row.index];
            return (
              identity && (
                <li
                  key={identity.id}
                  className={classes.row}
                  style={{ transform: `translateY(${row.start}px)`, height: ROW_PX }}
                >
                  <button
                    type="button"
                    className={classes.identity}
                    aria-pressed={identityIds.includes(identity.id)}
                    onClick={() => store.getState().select([identity.id])}
                    onDoubleClick={() => store.getState().setTab("selected")}
                    onPointerEnter={() => hover(identity)}
                    onPointerLeave={() => hover(null)}
                  >
                    <IdentityRow identity={identity} />
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

function IdentityRow({ identity }: { identity: Identity }) {
  return (
    <>
      <span className={classes.swatch} style={{ background: identityColour(identity.id) }} />
      <span className={classes.main}>
        <span className={classes.title}>
          #{identity.id} {identity.class_name}
        </span>
        <span className={classes.cameras}>{identity.camera_names.join(", ")}</span>
      </span>
      <span className={classes.numbers}>
        <span className={classes.score}>{score(identity.score)}</span>
        <span className={classes.quiet}>
          {text.identities.observations(identity.observation_count)},{" "}
          {text.identities.propagated(identity.propagated_count)}
        </span>
      </span>
    </>
  );
}
