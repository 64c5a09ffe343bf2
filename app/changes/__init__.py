"""What a decision of a person changed: all that a page has to know to be up to date."""
