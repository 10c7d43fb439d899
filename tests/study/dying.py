"""A task that ends its process."""

import os
import signal
from dataclasses import dataclass
from pathlib import Path

from isopeel.study.outcome import Outcome, Task


@dataclass(frozen=True)
class Dying(Task):
    """A task whose process is killed, as often as there are letters in its case."""

    def __call__(self) -> Outcome:
        deaths = Path(str(self.values["deaths"]))
        count = len(list(deaths.parent.glob(f"{deaths.name}-*")))
        if count < len(self.case_text):
            Path(f"{deaths}-{count}").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return Outcome("completed", steps=count)
