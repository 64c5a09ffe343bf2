"""One file for each step from one form of the store to the next."""
