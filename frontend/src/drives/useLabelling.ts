import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api, unwrap } from "../api/client";
import { isBusy, modelsQuery } from "../api/queries";
import type { Drive } from "../api/types";

/** Queues labelling of a drive; `null` leaves the model to the server. */
export function useLabelling(drive: Drive) {
  const client = useQueryClient();
  return useMutation({
    mutationFn: (model: string | null) =>
      unwrap(api.POST("/api/drives/{drive_id}/label", { params: { path: { drive_id: drive.id } }, body: { model } })),
    onSuccess: async () => {
      await Promise.all([
        client.invalidateQueries({ queryKey: ["drives"] }),
        client.invalidateQueries({ queryKey: ["drive", drive.id] }),
      ]);
    },
  });
}

/** The name of the model that labelled the drive, labels it, or would; and what to know before one trusts it. */
export function useModelOf(drive: Drive): { name: string | null; notice: string | null } {
  const models = useQuery(modelsQuery).data ?? [];
  if (drive.state === "ready") return { name: drive.model, notice: drive.notice };
  const busy = isBusy(drive) ? drive.job?.model : undefined;
  const model = models.find((one) => (busy === undefined ? one.default : one.name === busy));
  return { name: busy ?? model?.name ?? null, notice: drive.is_simulated ? null : (model?.notice ?? null) };
}
