"""Notebooks, figures, paper and report: what a reader sees."""

import sys

# jsonschema, which nbformat loads, takes this optional package to check the syntax of web
# addresses. No notebook needs that, and the package parses a grammar for two seconds as it loads.
sys.modules.setdefault("rfc3987_syntax", None)
