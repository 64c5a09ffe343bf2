"""Objects: connected components of tracks under the accepted merges."""
