"""`python -m partuv_worker`: a worker, as `partuv worker` starts it."""

import sys

from partuv_worker.command import command

sys.exit(command(sys.argv[1:]))
