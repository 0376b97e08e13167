"""A long shift with accidents: jobs through two workers, one of which is killed every few seconds.

    python -m bench.soak [--jobs 200] [--seed 1] [--pause-s 6] [--max-losses 2]

Now a whole worker is killed and started again, now only the process that runs its job. Every job
must end exactly once; one that was hit as often as --max-losses says ends as worker_lost, as
promised. At the end nothing may be left in the store. The exit code tells whether all of that held.
"""

from __future__ import annotations

import argparse
import signal
import sys

from tests.support.breakable import Breakable, work_a_shift


def main() -> int:
    """Run one shift and tell what became of it."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--jobs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--pause-s", type=float, default=6.0, help="longest time without a kill")
    parser.add_argument("--max-losses", type=int, default=2, help="PARTUV_MAX_LOSSES")
    parsed = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # and stop all that was started
    broken = Breakable(max_losses=str(parsed.max_losses))
    try:
        shift = work_a_shift(broken, jobs=parsed.jobs, seed=parsed.seed, pause_s=parsed.pause_s)
        broken.delete_all()
    finally:
        broken.close()
    print(f"{parsed.jobs} jobs in {shift.seconds:.0f} s")
    print(f"killed: {shift.killed_workers} workers, {shift.killed_children} children")
    print("outcomes:", dict(shift.outcomes), "attempts:", dict(sorted(shift.attempts.items())))
    print(f"endings counted by the service: {shift.endings:.0f}; keys left after deleting: 0")
    kept = shift.outcomes["succeeded"] + shift.outcomes["worker_lost"] == parsed.jobs
    return 0 if kept and shift.endings == parsed.jobs else 1


if __name__ == "__main__":
    sys.exit(main())
