import { Tabs } from "@mantine/core";
import type { MergeState } from "../api/types";
import { count } from "../app/format";
import { text } from "../strings";
import { ExportPanel } from "./exports/ExportPanel";
import { IdentitiesPanel } from "./identities/IdentitiesPanel";
import { SelectedPanel } from "./identities/SelectedPanel";
import { MergesPanel } from "./merges/MergesPanel";
import { useMerges } from "./merges/useDecisions";
import { useReview, useShared } from "./ReviewContext";
import classes from "./SidePanel.module.css";
import { TABS, type Tab } from "./urlState";

interface SidePanelProps {
  width: number;
  mergesShown: MergeState;
  onShowMerges: (state: MergeState) => void;
}

/** What to decide, what there is, what is selected, and the way out. */
export function SidePanel({ width, mergesShown, onShowMerges }: SidePanelProps) {
  const { drive } = useShared();
  const tab = useReview((state) => state.tab);
  const setTab = useReview((state) => state.setTab);
  const selected = useReview((state) => state.identityIds.length);
  const merges = useMerges();
  const numbers: Record<Tab, number> = {
    merges: merges.filter((merge) => merge.state === "proposed").length,
    identities: drive.identity_count,
    selected,
    export: 0,
  };
  return (
    <Tabs
      className={classes.tabs}
      value={tab}
      onChange={(value) => setTab(value as Tab)}
      keepMounted={false}
      aria-label={text.review.panel}
    >
      <Tabs.List className={classes.list}>
        {TABS.map((name) => (
          <Tabs.Tab key={name} value={name} className={classes.tab}>
            {text.review.tabs[name]}
            {numbers[name] > 0 && <span className={classes.number}>{count(numbers[name])}</span>}
          </Tabs.Tab>
        ))}
      </Tabs.List>
      <Tabs.Panel value="merges" className={classes.panel}>
        <MergesPanel shown={mergesShown} onShow={onShowMerges} width={width} />
      </Tabs.Panel>
      <Tabs.Panel value="identities" className={classes.panel}>
        <IdentitiesPanel />
      </Tabs.Panel>
      <Tabs.Panel value="selected" className={classes.panel}>
        <SelectedPanel width={width} />
      </Tabs.Panel>
      <Tabs.Panel value="export" className={classes.panel}>
        <ExportPanel />
      </Tabs.Panel>
    </Tabs>
  );
}
