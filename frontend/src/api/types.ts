/** The names of the contract, as the page uses them. */

import type { components } from "./schema.gen";

type Schemas = components["schemas"];

export type Drive = Schemas["Drive"];
export type DriveDetail = Schemas["DriveDetail"];
export type Observation = Schemas["Observation"];
export type Track = Schemas["Track"];
export type Identity = Schemas["Identity"];
export type Merge = Schemas["Merge"];
export type MergeState = Merge["state"];
export type MergeLooks = Schemas["MergeLooks"];
export type Look = Schemas["Look"];
export type Way = Schemas["Way"];
export type MergeChange = Schemas["MergeChange"];
/** What a decision of whatever kind changed; openapi-fetch forgets that a box has exactly four numbers. */
export type LabelChange = Omit<MergeChange, "merge" | "observations"> & { observations: readonly unknown[] | null };
export type Model = Schemas["Model"];
export type Edit = Schemas["Edit"];
export type EditChange = Schemas["EditChange"];
export type Correction = Schemas["EditRequest"]["edit"];
/** What the drive's events say: its revision, and the latest decision. */
export interface DriveRevision {
  revision: number;
  edit: Edit | null;
}
export type Job = Schemas["Job"];
export type Export = Schemas["Export"];
export type AuditBin = Schemas["AuditBin"];
export type LabelHistogram = Schemas["LabelHistogram"];
export type IdentityFacts = Schemas["IdentityFacts"];
export type PrecisionRecallCurve = Schemas["PrecisionRecallCurve"];
export type Evaluation = Schemas["Evaluation"];
