"""How long the server takes for what the queue asks: CPU seconds of this process, so that other work does not count.

    python -m tests.big_drive WORKSPACE
    python -m tests.big_drive.times WORKSPACE

Decisions that are made are undone again; the log keeps them.
"""

import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from app.db.engine import migrate, open_engine
from app.db.session import Store
from app.errors import CannotLink
from app.identities.service import identities_json
from app.merges import looks, service
from app.merges.schemas import Merge, MergeState
from app.motion.facts import FactsCache
from app.motion.service import list_facts
from app.summary.service import histogram
from app.tracks.service import observations_json, tracks_json

RUNS = 9


def measure(workspace: Path) -> dict[str, float]:
    """CPU milliseconds, the median of a few runs, by what is asked."""
    engine = open_engine(f"sqlite:///{workspace.absolute()}/hindsight.db")
    migrate(engine)
    store = Store(engine)
    with store.read() as session:
        answer = service.merges_json(session, 1, MergeState.PROPOSED)
    merges = TypeAdapter(list[Merge]).validate_json(answer)
    most_first = sorted(merges, key=lambda merge: (-merge.priority, merge.id))
    queue = [merge for merge in most_first[: 4 * RUNS] if _fits(store, merge.id)][:RUNS]
    cache = FactsCache()

    def read(ask: Callable[[Any], object]) -> Callable[[], object]:
        def run() -> object:
            with store.read() as session:
                return ask(session)

        return run

    def decide(merge_id: int) -> object:
        with store.write() as session:
            return service.accept_merge(session, merge_id, reviewer="benchmark")

    def undo(merge_id: int) -> object:
        with store.write() as session:
            return service.undo_merge(session, merge_id, reviewer="benchmark")

    found = {
        "list merges": _median([read(lambda session: service.merges_json(session, 1, None))] * RUNS),
        "list identities": _median([read(lambda session: identities_json(session, 1))] * RUNS),
        "list tracks": _median([read(lambda session: tracks_json(session, 1))] * RUNS),
        "looks of a merge": _median(
            [read(lambda session, one=merge: looks.looks_of_merge(session, one.id)) for merge in queue]
        ),
        "accept a merge": _median([lambda one=merge: decide(one.id) for merge in queue]),
        "undo a merge": _median([lambda one=merge: undo(one.id) for merge in queue]),
        "one frame of labels": _median([read(lambda session: observations_json(session, 1, 500, 501))] * RUNS),
        "facts, first": _median([read(lambda session: list_facts(session, cache, 1))]),
        "facts, again": _median([read(lambda session: list_facts(session, cache, 1))] * RUNS),
        "histogram": _median([read(lambda session: histogram(session, 1))] * 3),
    }
    engine.dispose()
    return found


def _fits(store: Store, merge_id: int) -> bool:
    """Whether a merge can be accepted: tries it, and takes it back."""
    try:
        with store.write() as session:
            service.accept_merge(session, merge_id, reviewer="benchmark")
        with store.write() as session:
            service.undo_merge(session, merge_id, reviewer="benchmark")
    except CannotLink:
        return False
    return True


def _median(jobs: list[Callable[[], object]]) -> float:
    times: list[float] = []
    for job in jobs:
        begun = time.process_time()
        job()
        times.append(1000 * (time.process_time() - begun))
    return statistics.median(times)


if __name__ == "__main__":
    for name, milliseconds in measure(Path(sys.argv[1])).items():
        sys.stdout.write(f"{name:24}{milliseconds:8.1f} ms of CPU\n")
