"""What the paper says, judged."""
