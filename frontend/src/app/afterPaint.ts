const UNSEEN_MS = 200;

/** Runs something once what is drawn now is on the screen; soon also where nothing is painted, as in a hidden tab. */
export function afterPaint(run: () => void): void {
  let done = false;
  const once = () => {
    if (done) return;
    done = true;
    run();
  };
  requestAnimationFrame(() => setTimeout(once));
  setTimeout(once, UNSEEN_MS);
}
