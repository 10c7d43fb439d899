"""Random cases with a known answer: drawing, running and judging them."""
