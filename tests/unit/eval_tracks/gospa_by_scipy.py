"""GOSPA (c 20 m, p 2, alpha 2) by scipy's assignment, against the results that stand beside the sets.

Lines of the file: "x EAST NORTH ..." truths, "y EAST NORTH ..." estimates, "g METRIC LOCALISATION MISSED FALSE" what the other program says of them.
The assignment here is over truths and estimates that may each stay alone for c^2 / 2, and not over distances that are cut off.
"""
import math
import sys

import numpy
from scipy.optimize import linear_sum_assignment

CUT_OFF_M = 20.0


def gospa(truths, estimates):
    alone = CUT_OFF_M**2 / 2.0
    n, m = len(truths), len(estimates)
    impossible = 1e9
    cost = numpy.full((n + m, n + m), 0.0)
    cost[:n, m:] = impossible
    cost[n:, :m] = impossible
    for i, x in enumerate(truths):
        for k, y in enumerate(estimates):
            cost[i, k] = (x[0] - y[0]) ** 2 + (x[1] - y[1]) ** 2
        cost[i, m + i] = alone
    for k in range(m):
        cost[n + k, k] = alone
    rows, columns = linear_sum_assignment(cost)
    pairs = [(i, k) for i, k in zip(rows, columns) if i < n and k < m]
    localisation = sum(cost[i, k] for i, k in pairs)
    missed, false = n - len(pairs), m - len(pairs)
    return math.sqrt(localisation + alone * (missed + false)), localisation, missed, false


def points(words):
    numbers = [float(word) for word in words]
    return list(zip(numbers[::2], numbers[1::2]))


def main():
    sets = {}
    num_compared = 0
    for line in open(sys.argv[1], encoding="utf-8"):
        name, *words = line.split()
        if name != "g":
            sets[name] = points(words)
            continue
        ours = gospa(sets["x"], sets["y"])
        theirs = [float(word) for word in words]
        num_compared += 1
        if any(abs(a - b) > 1e-9 * max(1.0, abs(a)) for a, b in zip(ours, theirs)):
            sys.exit(f"set {num_compared}: scipy says {ours}, the file {theirs}")
    if num_compared == 0:
        sys.exit("no sets")
    print(f"{num_compared} sets agree")


main()
