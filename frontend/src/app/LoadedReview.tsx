import { type ComponentType, lazy, useState } from "react";
import { driveQuery, queryClient } from "../api/queries";
import { reviewedDrive } from "./driveAddress";

type Review = ComponentType<{ driveId: number }>;

/** Longer than this, what is missing is not waited for: the page says that it loads. */
const PATIENCE_MS = 1_000;

let loaded: Review | undefined;

async function load(): Promise<{ default: Review }> {
  const { ReviewPage } = await import("../review/ReviewPage");
  loaded = ReviewPage;
  return { default: ReviewPage };
}

const LazyReview: Review = lazy(load);

/** The review page, at once where its code is here: React's `lazy` would show nothing for a third of a second. */
export function LoadedReview({ driveId }: { driveId: number }) {
  const [Page] = useState<Review>(() => loaded ?? LazyReview);
  return <Page driveId={driveId} />;
}

/** Loads what the review of a drive shows first, so that it is made once, whole. Does nothing for other pages. */
export async function preloadReview(pathname: string): Promise<void> {
  const drive = reviewedDrive(pathname);
  if (drive === undefined) return;
  const needed = Promise.allSettled([load(), queryClient.prefetchQuery(driveQuery(drive))]);
  await Promise.race([needed, new Promise((go) => setTimeout(go, PATIENCE_MS))]);
}
