import { useComputedColorScheme } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import {
  type PointerEvent,
  type RefObject,
  useCallback,
  useDeferredValue,
  useEffect,
  useLayoutEffect,
  useMemo,
  useRef,
  useState,
} from "react";
import { identitiesQuery, scoreRunsQuery, tracksQuery } from "../../api/queries";
import { useSize } from "../../app/useSize";
import { text } from "../../strings";
import { useMerges } from "../merges/useDecisions";
import { useReview, useShared } from "../ReviewContext";
import classes from "./Lanes.module.css";
import { type Arrangement, arrange, type Grouping, LANE_PAD_PX, lanesOf, linksOf, rowAt, rowHeight } from "./lanes";
import { type Ink, type LaneScene, paintLanes, wordsOf } from "./paint";
import { RULER_PX, Ruler, sized } from "./Ruler";
import { frameAt, panTime, reveal, type TimeView, zoomTime } from "./timeView";

const GUTTER_PX = 150;
const DRAG_FROM_PX = 4;
const WHEEL_SPEED = 0.0018;
const NONE: Readonly<Record<string, readonly number[]>> = {};

interface LanesProps {
  grouping: Grouping;
  view: TimeView;
  onView: (how: (view: TimeView) => TimeView) => void;
  height: number;
}

/** A lane for each identity, and the playhead across all of them. Only what is on the screen is painted. */
export function Lanes({ grouping, view, onView, height }: LanesProps) {
  const { drive, store } = useShared();
  const [ref, { width }] = useSize<HTMLDivElement>();
  const [closed, setClosed] = useState<ReadonlySet<string>>(new Set());
  const scroller = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const tip = useRef<HTMLDivElement>(null);
  const ink = useInk();
  const frame = useReview((state) => state.frame);
  // Two thousand lanes can wait a moment: what is selected shows in the pictures first.
  const identityIds = useDeferredValue(useReview((state) => state.identityIds));
  const hovered = useReview((state) => state.hover?.identityId ?? null);
  const mergeId = useDeferredValue(useReview((state) => state.mergeId));
  const selected = useMemo(() => new Set(identityIds), [identityIds]);
  const { arrangement, links, loading } = useLanes(grouping, closed, selected);
  const inner = Math.max(0, height - RULER_PX);

  const scene: Omit<LaneScene, "scrollTop"> = {
    width,
    height: inner,
    gutter: GUTTER_PX,
    view,
    arrangement,
    links,
    frame,
    selected,
    hovered,
    mergeId,
    closed,
    ink,
  };
  const latest = useRef(scene);
  latest.current = scene;
  const paint = useCallback(() => {
    const { width: wide, height: high } = latest.current;
    const ctx = sized(canvas.current, wide, high);
    if (ctx) paintLanes(ctx, { ...latest.current, scrollTop: scroller.current?.scrollTop ?? 0 });
  }, []);
  // biome-ignore lint/correctness/useExhaustiveDependencies: whatever the scene shows anew is painted anew.
  useLayoutEffect(paint, [width, inner, view, arrangement, links, frame, selected, hovered, mergeId, closed, ink]);
  useShowPlayhead(scroller, arrangement, frame);
  useShowSelected(scroller, arrangement, identityIds, inner);
  useEffect(() => onView((now) => reveal(now, frame, drive.frame_count)), [frame, drive.frame_count, onView]);

  const across = Math.max(1, width - GUTTER_PX);
  const zoom = useCallback(
    (deltaY: number, x: number) => {
      const at = Math.min(1, Math.max(0, (x - GUTTER_PX) / across));
      onView((now) => zoomTime(now, Math.exp(-deltaY * WHEEL_SPEED), at, drive.frame_count));
    },
    [across, drive.frame_count, onView],
  );
  const pan = useCallback(
    (byPx: number) => onView((now) => panTime(now, (byPx / across) * now.frames, drive.frame_count)),
    [across, drive.frame_count, onView],
  );
  useLaneWheel(scroller, zoom, pan);

  const at = (event: PointerEvent<HTMLElement>) => {
    const bounds = event.currentTarget.getBoundingClientRect();
    const [x, y] = [event.clientX - bounds.left, event.clientY - bounds.top + (scroller.current?.scrollTop ?? 0)];
    const index = rowAt(arrangement, y);
    const row = arrangement.rows[index];
    const inTime = x >= GUTTER_PX;
    const target = inTime ? frameAt(view, x - GUTTER_PX, across, drive.frame_count) : null;
    if (row?.kind !== "lane") return { x, y, row, target, segment: undefined };
    const step = rowHeight(row.lane, selected);
    const inRow = Math.floor((y - (arrangement.tops[index] as number) - LANE_PAD_PX / 2) / step);
    const segment =
      target === null
        ? undefined
        : row.lane.segments.find((one) => one.row === inRow && target >= one.first && target <= one.last);
    return { x, y, row, target, segment };
  };

  const press = useRef<{ x: number; moved: boolean } | null>(null);
  const onPointerMove = (event: PointerEvent<HTMLElement>) => {
    const start = press.current;
    if (start) {
      const by = event.clientX - start.x;
      if (!start.moved && Math.abs(by) < DRAG_FROM_PX) return;
      press.current = { x: event.clientX, moved: true };
      pan(-by);
      return;
    }
    const { x, y, row, target, segment } = at(event);
    const id = row?.kind === "lane" ? row.lane.identity.id : null;
    const { hover, setHover } = store.getState();
    if (id !== (hover?.identityId ?? null)) setHover(id === null ? null : { identityId: id, observationId: null });
    showTip(tip.current, row?.kind === "lane" ? wordsOf(row.lane, segment, target ?? -1) : "", {
      x,
      y: y - (scroller.current?.scrollTop ?? 0),
      width,
    });
  };
  const onLeave = () => {
    store.getState().setHover(null);
    showTip(tip.current, "", { x: 0, y: 0, width });
  };
  const onPointerUp = (event: PointerEvent<HTMLElement>) => {
    const start = press.current;
    press.current = null;
    if (!start || start.moved) return;
    const { row, target } = at(event);
    if (row?.kind === "group") {
      const next = new Set(closed);
      if (!next.delete(row.name)) next.add(row.name);
      setClosed(next);
      return;
    }
    const { select, seek, setPlaying, tab } = store.getState();
    if (row) select([row.lane.identity.id], tab === "identities" ? tab : "selected");
    if (target !== null) {
      setPlaying(false);
      seek(target);
    }
  };

  return (
    <section className={classes.lanes} ref={ref} style={{ height }} aria-label={text.timeline.lanes}>
      <Ruler
        view={view}
        width={width}
        gutter={GUTTER_PX}
        ink={ink}
        onWheel={(event) =>
          zoom(event.deltaY, event.clientX - event.currentTarget.getBoundingClientRect().left + GUTTER_PX)
        }
      />
      <section
        className={classes.scroller}
        ref={scroller}
        onScroll={paint}
        style={{ height: inner }}
        // biome-ignore lint/a11y/noNoninteractiveTabindex: what scrolls must be reachable by keys.
        tabIndex={0}
        aria-label={text.timeline.lanesHelp}
      >
        <div style={{ height: Math.max(inner, arrangement.tops.at(-1) ?? 0) }}>
          <canvas
            ref={canvas}
            className={classes.sticky}
            style={{ width, height: inner }}
            role="img"
            aria-label={text.timeline.lanesOf(arrangement.rows.filter((row) => row.kind === "lane").length)}
            onPointerDown={(event) => {
              if (event.button !== 0) return;
              event.currentTarget.setPointerCapture(event.pointerId);
              press.current = { x: event.clientX, moved: false };
            }}
            onPointerMove={onPointerMove}
            onPointerUp={onPointerUp}
            onPointerCancel={() => {
              press.current = null;
            }}
            onPointerLeave={onLeave}
          />
        </div>
      </section>
      {arrangement.rows.length === 0 && (
        <div className={classes.empty}>{loading ? text.timeline.loading : text.timeline.empty}</div>
      )}
      <div ref={tip} className={classes.tip} aria-hidden />
    </section>
  );
}

function useLanes(grouping: Grouping, closed: ReadonlySet<string>, selected: ReadonlySet<number>) {
  const { driveId } = useShared();
  const tracks = useDeferredValue(useQuery(tracksQuery(driveId)).data);
  const identities = useDeferredValue(useQuery(identitiesQuery(driveId)).data);
  const runs = useQuery({ ...scoreRunsQuery(driveId, tracks), enabled: tracks !== undefined }).data?.runs;
  const merges = useDeferredValue(useMerges());
  const lanes = useMemo(
    () => (tracks && identities ? lanesOf(identities, tracks, runs ?? NONE) : []),
    [identities, tracks, runs],
  );
  const arrangement = useMemo(() => arrange(lanes, grouping, closed, selected), [lanes, grouping, closed, selected]);
  const links = useMemo(() => linksOf(merges, arrangement), [merges, arrangement]);
  return { arrangement, links, loading: !tracks || !identities };
}

/** Begins with the lanes that the playhead crosses. */
function useShowPlayhead(scroller: RefObject<HTMLDivElement | null>, arrangement: Arrangement, frame: number): void {
  const done = useRef(false);
  useEffect(() => {
    const element = scroller.current;
    if (!element || done.current || arrangement.rows.length === 0) return;
    done.current = true;
    const index = arrangement.rows.findIndex((row) => row.kind === "lane" && row.lane.identity.last_frame >= frame);
    // The first lanes stay under the head of their group.
    if (index > 1) element.scrollTop = arrangement.tops[index] as number;
  }, [scroller, arrangement, frame]);
}

/** Scrolls to what was selected elsewhere, if it is not on the screen. */
function useShowSelected(
  scroller: RefObject<HTMLDivElement | null>,
  arrangement: Arrangement,
  identityIds: readonly number[],
  height: number,
): void {
  const shown = useRef<readonly number[]>([]);
  useEffect(() => {
    const element = scroller.current;
    const [id] = identityIds;
    if (!element || id === undefined || shown.current === identityIds || arrangement.rows.length === 0) return;
    shown.current = identityIds;
    const index = arrangement.rows.findIndex((row) => row.kind === "lane" && row.lane.identity.id === id);
    if (index < 0) return;
    const [top, bottom] = [arrangement.tops[index] as number, arrangement.tops[index + 1] as number];
    if (top < element.scrollTop || bottom > element.scrollTop + height) {
      element.scrollTop = Math.max(0, top - height / 3);
    }
  }, [scroller, arrangement, identityIds, height]);
}

/** A plain wheel scrolls the lanes; with Ctrl it zooms, with Shift or sideways it pans. */
function useLaneWheel(
  scroller: RefObject<HTMLDivElement | null>,
  zoom: (deltaY: number, x: number) => void,
  pan: (byPx: number) => void,
): void {
  useEffect(() => {
    const element = scroller.current;
    if (!element) return;
    const onWheel = (event: WheelEvent) => {
      const sideways = event.shiftKey ? event.deltaY || event.deltaX : event.deltaX;
      if (event.ctrlKey || event.altKey) zoom(event.deltaY, event.clientX - element.getBoundingClientRect().left);
      else if (Math.abs(sideways) > Math.abs(event.shiftKey ? 0 : event.deltaY)) pan(sideways);
      else return;
      event.preventDefault();
    };
    element.addEventListener("wheel", onWheel, { passive: false });
    return () => element.removeEventListener("wheel", onWheel);
  }, [scroller, zoom, pan]);
}

/** The page's own colours, read once for each colour scheme. */
function useInk(): Ink {
  const scheme = useComputedColorScheme("dark");
  return useMemo(() => {
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(name).trim();
    return {
      words: colour("--mantine-color-text") || (scheme === "dark" ? "#d9dce3" : "#000"),
      muted: colour("--muted"),
      line: colour("--line"),
      raised: colour("--surface-raised"),
      hover: colour("--surface-hover"),
      active: colour("--surface-active"),
      rim: scheme === "dark" ? "rgba(0, 0, 0, 0.6)" : "rgba(20, 24, 32, 0.55)",
      accent: scheme === "dark" ? "#91a7ff" : "#364fc7",
    };
  }, [scheme]);
}

function showTip(tip: HTMLDivElement | null, words: string, at: { x: number; y: number; width: number }): void {
  if (!tip) return;
  tip.textContent = words;
  tip.hidden = words === "";
  const left = Math.min(at.x + 14, Math.max(0, at.width - tip.offsetWidth - 8));
  tip.style.transform = `translate(${left}px, ${Math.max(0, at.y + RULER_PX - 30)}px)`;
}
