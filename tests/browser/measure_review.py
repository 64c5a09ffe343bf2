"""Measure the review page in headless Chromium on the big drive, as a person would feel it.

    python -m tests.browser.measure_review [--workspace FOLDER] [--minutes 10]

Makes the drive of :mod:`tests.big_drive` in the folder (a temporary one if none is named), serves it with
``hindsight serve``, and prints one line for each figure and its goal, and all of them as JSON. It is no test: what a
busy machine measures says little. The load of the machine is printed with the figures.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import statistics
import sys
import tempfile
from itertools import pairwise
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, ViewportSize, expect

from tests.big_drive.making import make_workspace
from tests.browser.memory import watch_memory
from tests.browser.serving import serving
from tests.chromium import headless_chromium

SIZE: ViewportSize = {"width": 1600, "height": 1000}
SLOW_MS = 60_000
START, WARM_FRAMES, STEPS, PLAYED, SCROLL_SECONDS, MERGES, TRIES = 500, 60, 40, 100, 5, 10, 60
PERIOD_MS = 100.0
LATE_MS = 50.0

# Notes when frames come to the screen, from before the page's own code runs. A change is "seen" in the task after the
# animation frame that it was made for: by then the browser has been given it to paint.
NOTES = """
window.notes = {frames: [], first: null, answered: 0};
new PerformanceObserver(() => { notes.answered = performance.now(); }).observe({type: "resource"});
window.painted = (then) => requestAnimationFrame(() => {
  const channel = new MessageChannel();
  channel.port1.onmessage = () => then(performance.now());
  channel.port2.postMessage(null);
});
new MutationObserver(() => {
  const views = [...document.querySelectorAll("figure[data-frame]")];
  if (views.length < 4) return;
  const frame = Number(views[0].dataset.frame);
  if (notes.frames.at(-1)?.frame === frame) return;
  const note = {frame, at: null};
  notes.frames.push(note);
  painted((now) => { note.at = now; notes.first ??= now; });
}).observe(document, {subtree: true, childList: true, attributes: true, attributeFilter: ["data-frame"]});
"""

GO_TO = """(frame) => {
  history.replaceState(null, "", `?frame=${frame}`);
  dispatchEvent(new PopStateEvent("popstate"));
}"""

STEP = """async (steps) => {
  const times = [];
  for (let step = 0; step < steps; step += 1) {
    const known = notes.frames.length;
    const begun = performance.now();
    window.dispatchEvent(new KeyboardEvent("keydown", {key: "f", bubbles: true}));
    while (!(notes.frames.length > known && notes.frames.at(-1).at)) await new Promise((go) => setTimeout(go, 1));
    times.push(notes.frames.at(-1).at - begun);
    await new Promise((go) => setTimeout(go, 60));
  }
  return times;
}"""

SCROLL = """async (seconds) => {
  const lanes = document.querySelector("[aria-label^='Lanes of identities']");
  const times = [];
  await new Promise((end) => {
    const begun = performance.now();
    const step = (now) => {
      times.push(now);
      lanes.scrollTop += lanes.scrollTop + lanes.clientHeight >= lanes.scrollHeight - 1 ? -lanes.scrollHeight : 37;
      if (now - begun < seconds * 1000) requestAnimationFrame(step);
      else end();
    };
    requestAnimationFrame(step);
  });
  return times;
}"""

# The page follows the drive's events for as long as it is open, so Playwright never finds its network idle.
QUIET = "() => performance.now() - notes.answered > 1000"

# From the key to the screen with the labels that the server made of the decision, in all cameras; to the screen with
# the next merge's frame and these labels; and to the server's answer. Null where the server refuses the decision.
ACCEPT = """async () => {
  performance.clearResourceTimings();
  const begun = performance.now();
  window.dispatchEvent(new KeyboardEvent("keydown", {key: "a", bubbles: true}));
  const answer = () => performance.getEntriesByType("resource").find((one) => one.name.endsWith("/accept"));
  const views = [...document.querySelectorAll("figure[data-frame]")];
  const before = Number(views[0].dataset.revision);
  const playhead = document.querySelector("[role=slider][aria-label=Frame]");
  const isNew = (view) => Number(view.dataset.revision) > before;
  const isThere = (view) => Number(view.dataset.frame) === playhead.ariaValueNow - 1;
  let repainted = null;
  while (performance.now() - begun < 60000) {
    if (answer()?.responseStatus >= 400) return null;
    if (answer() && views.every(isNew)) {
      repainted ??= new Promise(painted);
      if (views.every(isThere)) {
        const next = await new Promise(painted);
        return {repainted: (await repainted) - begun, next: next - begun, answered: answer().responseEnd - begun};
      }
    }
    await new Promise((go) => setTimeout(go, 2));
  }
  return null;
}"""


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--workspace", type=Path, help="Where the drive is, or is to be made.")
    options.add_argument("--minutes", type=float, default=10.0, help="How long to play while memory is watched.")
    given = options.parse_args()
    with tempfile.TemporaryDirectory(prefix="hindsight-review-") as folder:
        workspace: Path = given.workspace or Path(folder)
        if not (workspace / "hindsight.db").exists():
            make_workspace(workspace)
        with serving(workspace) as address, headless_chromium(webgl=False) as browser:
            figures = measure(browser, f"{address.rstrip('/')}/drives/1", minutes=given.minutes)
    sys.stdout.write(json.dumps(figures) + "\n")


def measure(browser: Browser, address: str, *, minutes: float) -> dict[str, Any]:
    """All figures, by name; each is printed as it comes."""
    say("load of the machine", f"{os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
    figures: dict[str, Any] = {"load": os.getloadavg()[0]}
    views = [first_view_ms(browser, address) for _ in range(3)]
    figures["first_view_ms"] = statistics.median(views)
    say("first useful view", f"{figures['first_view_ms']:.0f} ms (goal 1500)")
    page = open_page(browser, f"{address}?frame={START}")
    expect(page.get_by_role("img", name=re.compile("lanes, one for each identity"))).to_be_visible(timeout=SLOW_MS)
    page.wait_for_function(QUIET)

    play_to(page, START + WARM_FRAMES)
    page.goto(f"{address}?frame={START}")
    page.wait_for_function("() => notes.first !== null")
    page.wait_for_function(QUIET)
    play_to(page, START + WARM_FRAMES)
    seek(page, START)
    steps: list[float] = page.evaluate(STEP, STEPS)
    figures |= {"step_median_ms": statistics.median(steps), "step_95_ms": percentile(steps, 95)}
    median, high = figures["step_median_ms"], figures["step_95_ms"]
    say("frame step, warm cache", f"{median:.0f} ms, 95 of 100 within {high:.0f} ms (goal 50)")

    figures |= playback(page, START + WARM_FRAMES)
    played = f"{figures['played_fps']:.1f} frames a second, {figures['frames_skipped']} skipped, "
    say("playback", f"{played}{figures['frames_late']} of {PLAYED} more than {LATE_MS:.0f} ms late (goal 10, 0, 0)")

    times: list[float] = page.evaluate(SCROLL, SCROLL_SECONDS)
    figures["scroll_fps"] = (len(times) - 1) / (times[-1] - times[0]) * 1000
    say("timeline scroll", f"{figures['scroll_fps']:.0f} frames a second (goal 50)")

    decided = accepts(page)
    figures["accept_ms"] = statistics.median(one["repainted"] for one in decided)
    figures["accept_answer_ms"] = statistics.median(one["answered"] for one in decided)
    figures["next_merge_ms"] = statistics.median(one["next"] for one in decided)
    answered = f"the server's answer after {figures['accept_answer_ms']:.0f} ms"
    say("accept to repainted labels", f"{figures['accept_ms']:.0f} ms, {answered} (goal 150)")
    say("accept to the next merge", f"{figures['next_merge_ms']:.0f} ms, its frame in all cameras")
    page.context.close()
    if minutes > 0:
        size = SIZE["width"], SIZE["height"]
        figures["memory"] = watch_memory(address, minutes=minutes, size=size, report=say)
    return figures


def first_view_ms(browser: Browser, address: str) -> float:
    """From the navigation to all cameras with their boxes, in a fresh profile."""
    page = open_page(browser, f"{address}?frame={START}")
    shown = page.evaluate("() => notes.first")
    page.context.close()
    return shown


def open_page(browser: Browser, address: str) -> Page:
    context = browser.new_context(viewport=SIZE, color_scheme="dark")
    context.set_default_timeout(SLOW_MS)
    context.add_init_script(NOTES)
    page = context.new_page()
    page.goto(address)
    page.wait_for_function("() => notes.first !== null")
    return page


def seek(page: Page, frame: int) -> None:
    page.evaluate(GO_TO, frame)
    page.wait_for_function("(frame) => notes.frames.at(-1)?.frame === frame && notes.frames.at(-1).at", arg=frame)


def play_to(page: Page, frame: int) -> None:
    page.keyboard.press("Space")
    page.wait_for_function("(frame) => notes.frames.at(-1)?.frame >= frame", arg=frame)
    page.keyboard.press("Space")


def playback(page: Page, start: int) -> dict[str, Any]:
    """How frames came while PLAYED of them were played at the drive's own ten a second."""
    seek(page, start)
    page.wait_for_timeout(1_000)
    known = page.evaluate("() => notes.frames.length")
    play_to(page, start + PLAYED)
    page.wait_for_timeout(300)
    notes: list[dict[str, float]] = page.evaluate("(known) => notes.frames.slice(known)", known)
    numbers = [int(one["frame"]) for one in notes]
    times = [one["at"] for one in notes]
    gaps = [after - before for before, after in pairwise(times)]
    return {
        "played_fps": (len(times) - 1) / (times[-1] - times[0]) * 1000,
        "frames_skipped": numbers[-1] - numbers[0] + 1 - len(set(numbers)),
        "frames_late": sum(gap > PERIOD_MS + LATE_MS for gap in gaps),
    }


def accepts(page: Page) -> list[dict[str, float]]:
    """Accepts merge after merge with the key, as they are worked through; goes past those that can't be accepted."""
    page.keyboard.press("j")
    page.wait_for_function(QUIET)
    found: list[dict[str, float]] = []
    for _ in range(TRIES):
        taken = page.evaluate(ACCEPT)
        page.wait_for_function(QUIET)
        if taken is None:
            page.keyboard.press("j")
            page.wait_for_function(QUIET)
            continue
        found.append(taken)
        if len(found) == MERGES:
            return found
    raise RuntimeError(f"Only {len(found)} of {TRIES} merges could be accepted: make the drive anew.")


def percentile(values: list[float], percent: int) -> float:
    return sorted(values)[min(len(values) - 1, len(values) * percent // 100)]


def say(what: str, found: str) -> None:
    sys.stdout.write(f"{what:<28}{found}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
