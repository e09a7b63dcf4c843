"""The cached force-depth curves, and what is fitted to them."""

from study.dataset.store import (
    DatasetError,
    links,
    load,
    measured,
    others,
    paper_curves,
    published,
    published_table_2,
    reference_forces,
    renewed,
    set_ups,
    summary,
    verify_files,
)
