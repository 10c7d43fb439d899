"""Run one program: `python -m peers NAME DEGREE ALONG ACROSS`."""

import importlib
import sys
from collections import deque

from peers.names import PROGRAMS
from peers.protocol import AbsentError, Start, own_output, say, serve, versions


def main(name: str, degree: int, elements: tuple[int, int]) -> None:
    """Report that the program is ready, or the reason that it is absent; then compute the angles read."""
    output = own_output()
    peer = PROGRAMS[name]
    pending: deque[float] = deque()
    try:
        start: Start = importlib.import_module(peer.module).start
        steps = start(degree, elements, iter(pending.popleft, None))
    except (ImportError, AbsentError) as error:
        say(output, absent=str(error))
    else:
        say(output, ready=versions(peer.libraries))
        serve(steps, pending, output)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), (int(sys.argv[3]), int(sys.argv[4])))
