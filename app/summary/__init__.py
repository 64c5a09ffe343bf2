"""The labels of a drive in a few numbers: how many, of what class, how far, how sure, and from where."""
