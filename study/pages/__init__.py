"""Notebooks, figures, paper and report: what a reader sees."""
