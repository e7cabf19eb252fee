"""Lower bound of a proportion, by Clopper and Pearson, with integers alone."""

from fractions import Fraction
from math import comb


def lower(successes, tries, confidence):
    """The probability at which so many successes or more come with a probability of 1 - confidence."""
    if successes == 0:
        return 0.0
    alpha = 1.0 - confidence

    def tail(p):
        p = Fraction(p)
        q = 1 - p
        return float(sum(comb(tries, k) * p**k * q ** (tries - k) for k in range(successes, tries + 1)))

    low, high = 0.0, 1.0
    for _ in range(24):
        middle = (low + high) / 2
        low, high = (middle, high) if tail(middle) < alpha else (low, middle)
    return low
