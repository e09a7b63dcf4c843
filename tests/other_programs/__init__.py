"""Other programs on the same problems, to compare with."""
