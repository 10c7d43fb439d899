"""For the cells of the site: `%%sh` that hands its output over whole and in order, and stops at a failure."""

import subprocess

from IPython.core.magic import register_cell_magic


@register_cell_magic
def sh(_line: str, cell: str) -> None:
    """Run a cell by the shell."""
    done = subprocess.run(
        ["sh", "-e", "-c", cell], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
    )
    print(done.stdout, end="")
    done.check_returncode()
