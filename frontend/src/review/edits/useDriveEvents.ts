/** What others change appears here: the server tells the drive's revision whenever its labels have changed. */

import { useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import type { DriveRevision } from "../../api/types";
import { text } from "../../strings";
import { useShared } from "../ReviewContext";
import { describeEdit } from "./describe";
import { RevisionNews } from "./revisionNews";
import { useEditNotice } from "./useEdits";

/** A change that is our own is known when its request is answered; events may come first. */
const OWN_ANSWER_MS = 250;

export function useDriveEvents(): void {
  const { driveId, observations } = useShared();
  const client = useQueryClient();
  useEffect(() => {
    const timers = new Set<ReturnType<typeof setTimeout>>();
    const revisions = new RevisionNews();
    const source = new EventSource(`/api/drives/${driveId}/events`);
    const onRevision = ({ revision, edit }: DriveRevision) => {
      if (client.isMutating({ mutationKey: ["decide", driveId] }) > 0) return later({ revision, edit });
      if (observations.wasChangedHere(revision)) return;
      void client.invalidateQueries({ queryKey: ["drive", driveId] });
      if (edit) useEditNotice.getState().show("other", text.edits.byOther(edit.reviewer, describeEdit(edit)));
    };
    const later = (news: DriveRevision) => {
      const timer = setTimeout(() => {
        timers.delete(timer);
        onRevision(news);
      }, OWN_ANSWER_MS);
      timers.add(timer);
    };
    source.addEventListener("revision", (event) => {
      const news: DriveRevision = JSON.parse((event as MessageEvent<string>).data);
      if (revisions.isNews(news.revision, observations.knownRevision())) later(news);
    });
    return () => {
      source.close();
      for (const timer of timers) clearTimeout(timer);
    };
  }, [driveId, observations, client]);
}
