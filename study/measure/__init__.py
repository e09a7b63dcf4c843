"""Speed against accuracy, and where methods fail."""
