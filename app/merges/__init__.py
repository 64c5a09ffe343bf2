"""Claims that two tracks are one object, and what a person says to them."""
