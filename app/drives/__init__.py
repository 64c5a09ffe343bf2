"""Recorded drives: registering, uploading, listing, labelling."""
