"""Laws at numbers of any size: one clear error, or a finite force, never a silent wrong number."""

import re
from functools import partial
from math import inf

import numpy as np
from helpers.laws import VARIANTS
from hypothesis import given
from hypothesis import strategies as st

from study import contact

SIZES = st.floats(1e-12, 1e12)
ANY = st.floats(-1e15, 1e15) | st.sampled_from([np.nan, inf, -inf])


def tells(error):
    assert re.search("must be .* got", str(error))


@given(depth=ANY, r2_star=ANY, n=st.integers(1, 50))
def test_a_law_gives_a_positive_force_or_refuses(depth, r2_star, n):
    laws = [law() for law in contact.LAWS.values() if not law.needs_joint]
    for law in [*laws, contact.Steuermann(n, "profile")]:
        call = partial(law, depth, r2_star)
        for derivative in (False, True):
            try:
                value = call(derivative=derivative)
            except ValueError as error:
                tells(error)
                continue
            assert np.isfinite(value)
            assert (value > 0) == (depth > 1e-200)  # the power of a smaller one is 0


@given(depth=SIZES, gap=st.floats(1e-15, 1), socket=SIZES, modulus=SIZES)
def test_a_force_in_si_units_neither_overflows_nor_vanishes(depth, gap, socket, modulus):
    sizes = {"ball_radius": socket * (1 - gap), "socket_radius": socket}
    for law in VARIANTS.values():
        for derivative in ("force", "stiffness"):
            try:
                in_si_units = contact.DimensionalLaw(
                    law(1 / gap), composite_modulus=modulus, **sizes
                )
                value = getattr(in_si_units, derivative)(depth)
            except ValueError as error:
                tells(error)
                continue
            assert 0 < value < inf


@given(ANY, ANY, ANY, ANY)
def test_a_composite_modulus_is_between_half_of_the_lesser_and_infinity(e1, nu1, e2, nu2):
    try:
        found = contact.composite_modulus(e1, nu1, e2, nu2)
    except ValueError as error:
        tells(error)
        return
    assert min(e1, e2) / 2.01 <= found < inf
