"""The command `isopeel`, and `python -m isopeel`. Ctrl-C is handled before anything else is imported."""

import sys


def main() -> int:
    """Run the command line of this process, and return its exit code."""
    from isopeel.common.interrupts import ending_this_process

    with ending_this_process():
        from isopeel.cli import main as run_command

        return run_command()


if __name__ == "__main__":
    sys.exit(main())
