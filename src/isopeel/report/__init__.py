"""Documents of blocks, written as Markdown and as one HTML page; no study and no validation."""
