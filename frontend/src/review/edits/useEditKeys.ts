import { useActions } from "../keys/actions";
import { useReview } from "../ReviewContext";
import { useDrawing } from "./useBoxTool";
import { useCommenting } from "./useCommenting";
import { useEditActions } from "./useEditActions";

/** The keys of corrections. */
export function useEditKeys(openLog: () => void): void {
  const actions = useEditActions();
  const setTab = useReview((state) => state.setTab);
  const drawing = useDrawing((state) => state.on);
  useActions({
    ...Object.fromEntries([1, 2, 3, 4, 5, 6, 7, 8, 9].map((n) => [`class${n}`, () => actions.setKeyedClass(n)])),
    split: actions.split,
    join: actions.join,
    swap: actions.swap,
    draw: actions.toggleDrawing,
    interpolate: () => void actions.interpolate(),
    rejectDonor: () => actions.rejectDonor(),
    markReviewed: () => actions.mark("reviewed"),
    markIgnored: () => actions.mark("ignored"),
    markOpen: () => actions.mark("open"),
    comment: () => {
      setTab("selected");
      useCommenting.getState().set(true);
    },
    deleteBox: actions.deleteBoxesHere,
    deleteObject: actions.deleteObjects,
    undoEdit: actions.undo,
    redoEdit: actions.redo,
    log: openLog,
    ...(drawing && { clear: () => useDrawing.getState().set(false) }),
  });
}
