"""Migrations of the store; ``app.db.engine.migrate`` runs them."""
