"""Random cases with a known answer: how they are drawn, run and judged."""
