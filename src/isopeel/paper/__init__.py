"""The published study: its tables as data, its runs, and the sections and figures of its report."""
