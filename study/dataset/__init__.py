"""The stored force-depth curves, and the coefficients of laws that are fitted to them."""

from study.dataset.store import (
    DatasetError,
    load,
    measured,
    others,
    paper_curves,
    published,
    published_table_2,
    reference_forces,
    renewed,
    summary,
    verify,
)
