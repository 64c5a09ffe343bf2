"""Images of a drive for the browser."""
