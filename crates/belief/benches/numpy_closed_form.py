"""The peer of the bench `maps`: the same closed forms in numpy, whole planes at a time, single precision.

Prints one line a rule: its name and the median time of a call in seconds. Usage: numpy_closed_form.py SIDE
"""

import statistics
import sys
import time

import numpy as np


def planes(side):
    """Three sources of random masses that sum to 1, as float32 planes i, n, u, p."""
    rng = np.random.default_rng(1)
    sources = []
    for _ in range(3):
        weights = rng.random((4, side, side), dtype=np.float32)
        sources.append(weights / weights.sum(axis=0))
    return sources


def products(sources):
    """A = prod(i + u), B = prod(n + u), C = prod(u)."""
    (i0, n0, u0, _), (i1, n1, u1, _), (i2, n2, u2, _) = sources
    a = (i0 + u0) * (i1 + u1) * (i2 + u2)
    b = (n0 + u0) * (n1 + u1) * (n2 + u2)
    return a, b, u0 * u1 * u2


def to_ignorance(sources):
    return [(i, n, u + p, None) for i, n, u, p in sources]


def dsmc(sources):
    a, b, c = products(sources)
    return a - c, b - c, c, 1 - a - b + c


def belief(sources):
    (i0, _, _, p0), (i1, _, _, p1), (i2, _, _, p2) = sources
    return 1 - (1 - i0 - p0) * (1 - i1 - p1) * (1 - i2 - p2)


def dempster(sources):
    a, b, c = products(to_ignorance(sources))
    z = 1 / (a + b - c)
    return (a - c) * z, (b - c) * z, c * z


def yager(sources):
    a, b, c = products(to_ignorance(sources))
    return a - c, b - c, 1 - a - b + 2 * c


def pcr6(sources):
    masses = [(i, n, u) for i, n, u, _ in to_ignorance(sources)]
    a, b, c = products(to_ignorance(sources))
    fused = [a - c, b - c, c.copy()]
    for one in range(3):
        for two in range(3):
            for three in range(3):
                said = (one, two, three)
                if 0 not in said or 1 not in said:
                    continue
                parts = [masses[source][what] for source, what in enumerate(said)]
                share = parts[0] * parts[1] * parts[2] / (parts[0] + parts[1] + parts[2])
                for what, part in zip(said, parts):
                    fused[what] += share * part
    return fused


def main():
    side = int(sys.argv[1])
    sources = planes(side)
    for rule in (dsmc, belief, dempster, yager, pcr6):
        rule(sources)
        times = []
        for _ in range(9):
            start = time.perf_counter()
            rule(sources)
            times.append(time.perf_counter() - start)
        print(rule.__name__, statistics.median(times))


main()
