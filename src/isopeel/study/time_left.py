"""The time that a study still takes."""

from rich.progress import ProgressColumn, Task
from rich.text import Text


class TimeLeft(ProgressColumn):
    """A column with the time left, from the mean time of the runs that were finished since the start.

    The time that `rich` shows is that of the last seconds, in which no run may have been finished.
    """

    max_refresh = 0.5

    def render(self, task: Task) -> Text:
        """Return the time; none before the first run is finished."""
        done = int(task.completed) - int(task.fields["known"])
        if not done or task.elapsed is None or task.remaining is None:
            return Text("-:--:--", style="progress.remaining")
        return Text(clock(seconds_left(task.elapsed, done, int(task.remaining))), style="progress.remaining")


def seconds_left(elapsed: float, done: int, remaining: int) -> float:
    """Return the seconds that the remaining runs take, if they take as long as those that are done.

    The runs are computed in a random order, so that those that are done are a sample of all.
    """
    return elapsed / done * remaining


def clock(seconds: float) -> str:
    """Return a time as hours, minutes and seconds."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}"
