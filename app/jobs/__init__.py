"""Long work: a queue in the store, a worker process, progress for the browser."""
