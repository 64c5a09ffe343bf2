"""The store: engine, sessions and the base of all tables."""
