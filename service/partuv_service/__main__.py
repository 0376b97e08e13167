"""`python -m partuv_service`: a gateway, as `partuv gateway` starts it."""

import sys

from partuv_service.command import command

sys.exit(command(sys.argv[1:]))
