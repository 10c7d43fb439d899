"""Documents: Markdown and one HTML page from blocks; it knows neither study nor validation."""
