/** What the page reads from the server, with one key for each. */

import {
  infiniteQueryOptions,
  keepPreviousData,
  QueryClient,
  queryOptions,
  replaceEqualDeep,
} from "@tanstack/react-query";
import { keepPriorities } from "../review/queue/queueLists";
import { ApiError, api, unwrap } from "./client";
import type { Drive, DriveDetail, Merge, MergeLooks, Track } from "./types";

export const queryClient = new QueryClient({
  defaultOptions: {
    queries: {
      // The server is on this machine or in this house: the browser's idea of being online says nothing about it.
      networkMode: "always",
      staleTime: 30_000,
      retry: (failures, error) => !(error instanceof ApiError && error.status < 500) && failures < 2,
      retryDelay: 500,
    },
    mutations: { networkMode: "always", retry: false },
  },
});

export function isBusy(drive: Pick<Drive, "state">): boolean {
  return drive.state === "queued" || drive.state === "labelling";
}

export const drivesQuery = queryOptions({
  queryKey: ["drives"],
  queryFn: ({ signal }) => unwrap(api.GET("/api/drives", { signal })),
  // Progress comes by events; this finds drives that wait, and what others do.
  refetchInterval: (query) => (query.state.data?.some(isBusy) ? 3_000 : 15_000),
});

export const modelsQuery = queryOptions({
  queryKey: ["models"],
  queryFn: ({ signal }) => unwrap(api.GET("/api/models", { signal })),
  staleTime: 15_000, // a model may be pulled meanwhile
});

const at = (id: number) => ({ params: { path: { drive_id: id } } });

export const driveQuery = (id: number) =>
  queryOptions({
    queryKey: ["drive", id],
    queryFn: ({ signal }) => unwrap(api.GET("/api/drives/{drive_id}", { ...at(id), signal })),
    refetchInterval: (query) => (query.state.data && isBusy(query.state.data) ? 3_000 : 15_000),
  });

export const tracksQuery = (id: number) =>
  queryOptions({
    queryKey: ["drive", id, "tracks"],
    queryFn: ({ signal }) => unwrap(api.GET("/api/drives/{drive_id}/tracks", { ...at(id), signal })),
  });

/** Asked for anew only when tracks have changed: merges leave them as they are. */
export const scoreRunsQuery = (id: number, tracks: readonly Track[] = []) =>
  queryOptions({
    queryKey: ["score runs", id, tracks.length, tracks.reduce((sum, one) => sum + one.id * one.observation_count, 0)],
    queryFn: ({ signal }) => unwrap(api.GET("/api/drives/{drive_id}/tracks/runs", { ...at(id), signal })),
    staleTime: Number.POSITIVE_INFINITY,
    placeholderData: keepPreviousData,
  });

export const identitiesQuery = (id: number) =>
  queryOptions({
    queryKey: ["drive", id, "identities"],
    queryFn: ({ signal }) => unwrap(api.GET("/api/drives/{drive_id}/identities", { ...at(id), signal })),
  });

export const commentsQuery = (id: number) =>
  queryOptions({
    queryKey: ["drive", id, "comments"],
    queryFn: ({ signal }) => unwrap(api.GET("/api/drives/{drive_id}/comments", { ...at(id), signal })),
  });

/** The log, newest first, a page at a time. */
export const editsQuery = (id: number) =>
  infiniteQueryOptions({
    queryKey: ["drive", id, "edits"],
    initialPageParam: null as number | null,
    queryFn: ({ signal, pageParam }) => {
      const params = { path: { drive_id: id }, query: { before: pageParam } };
      return unwrap(api.GET("/api/drives/{drive_id}/edits", { params, signal }));
    },
    getNextPageParam: (page) => page.next_before,
  });

export const mergesKey = (id: number) => ["drive", id, "merges"] as const;

export const mergesQuery = (id: number) =>
  queryOptions({
    queryKey: mergesKey(id),
    queryFn: ({ signal }) => unwrap(api.GET("/api/drives/{drive_id}/merges", { ...at(id), signal })),
    structuralSharing: (before, after) =>
      replaceEqualDeep(before, keepPriorities(before as Merge[] | undefined, after as Merge[])),
  });

/**
 * What there is to see of a merge. Only whose identity a look is of can change; what is shown stays until it is new.
 * `turn`: what to wait for before the server is asked.
 */
export const mergeLooksQuery = (driveId: number, mergeId: number, turn?: () => Promise<void>) =>
  queryOptions({
    queryKey: ["drive", driveId, "looks", mergeId],
    queryFn: async ({ signal }) => {
      await turn?.();
      const path = { merge_id: mergeId };
      // openapi-fetch forgets that a merge has exactly two sides.
      return (await unwrap(api.GET("/api/merges/{merge_id}/looks", { params: { path }, signal }))) as MergeLooks;
    },
    staleTime: Number.POSITIVE_INFINITY,
  });

/** Counted anew by the server each time, in seconds for a long drive: so once for each revision of the labels. */
export const evaluationQuery = ({ id, revision }: Pick<DriveDetail, "id" | "revision">) =>
  queryOptions({
    queryKey: ["drive", id, "evaluation", revision],
    queryFn: ({ signal }) => unwrap(api.GET("/api/drives/{drive_id}/evaluation", { ...at(id), signal })),
    staleTime: Number.POSITIVE_INFINITY,
    placeholderData: keepPreviousData,
  });

/** Counts of labels: one answer for each revision of them, small enough to try any threshold in the page. */
export const histogramQuery = ({ id, revision }: Pick<DriveDetail, "id" | "revision">) =>
  queryOptions({
    queryKey: ["drive", id, "histogram", revision],
    queryFn: ({ signal }) => unwrap(api.GET("/api/drives/{drive_id}/histogram", { ...at(id), signal })),
    staleTime: Number.POSITIVE_INFINITY,
    placeholderData: keepPreviousData,
  });

/** The last audit of the labels as they are; null where there is none. Decisions of people don't change it. */
export const auditQuery = (id: number) =>
  queryOptions({
    queryKey: ["drive", id, "audit"],
    queryFn: ({ signal }) => unwrap(api.GET("/api/drives/{drive_id}/audit", { ...at(id), signal })),
  });

/** How far what is in some boxes was from the car: 3D boxes of a labelling never change. */
export const distancesQuery = (id: number, observationIds: readonly number[]) =>
  queryOptions({
    queryKey: ["distances", id, ...observationIds],
    queryFn: async ({ signal }) => {
      const params = { path: { drive_id: id }, query: { observation_id: [...observationIds] } };
      const found = await unwrap(api.GET("/api/drives/{drive_id}/distances", { params, signal }));
      return new Map(found.map((one) => [one.observation_id, one.distance_m]));
    },
    enabled: observationIds.length > 0,
    staleTime: Number.POSITIVE_INFINITY,
  });

/** Distances and failed checks of identities, for each revision of them. */
export const factsQuery = ({ id, revision }: Pick<DriveDetail, "id" | "revision">) =>
  queryOptions({
    queryKey: ["drive", id, "facts", revision],
    queryFn: ({ signal }) => unwrap(api.GET("/api/drives/{drive_id}/facts", { ...at(id), signal })),
    staleTime: Number.POSITIVE_INFINITY,
    placeholderData: keepPreviousData,
  });
