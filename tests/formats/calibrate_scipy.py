#!/usr/bin/env python3
"""Repeats the last fit of lookout-calibrate with scipy's least_squares, on the pairs of scans that --pairs wrote, and compares.

    calibrate_scipy.py PAIRS.csv     exit code 0: the same mounting and latency; 1: not; 77: no scipy here
"""
import csv
import sys

try:
    import numpy as np
    from scipy.optimize import least_squares
    from scipy.spatial.transform import Rotation
except ImportError:
    print("python3-scipy is not here: skipped")
    sys.exit(77)

LATENCY_STEP_S = 0.002
CAUCHY = 2.0
PRIOR_SD = np.array([0.5, 0.5, 0.5, 0.3, 0.3, 0.05, 0.05, 0.05])
# Far below what the recording tells: 0.01 deg, 0.2 ms, 2 mm.
TOLERANCE = np.array([np.radians(0.01)] * 3 + [2e-4] * 2 + [2e-3] * 3)


def read(file):
    with open(file, encoding="ascii") as lines:
        found = np.array([float(word) for word in next(lines).split()[2:]])
        lidar = np.array([float(word) for word in next(lines).split()[2:]])
        rows = list(csv.DictReader(lines))

    def matrices(name, height, width):
        return np.array([[[float(row[f"{name}_{i}{k}"]) for k in range(width)] for i in range(height)] for row in rows])

    poses = {name: matrices(name, 3, 4) for name in ("lidar", "begin0", "end0", "begin1", "end1", "begin2", "end2")}
    return found, lidar, poses, matrices("weight", 6, 6)


def split(T):
    return Rotation.from_matrix(T[:, :, :3]), T[:, :, 3]


def inverse(R, t):
    return R.inv(), -R.inv().apply(t)


def product(a, b):
    return a[0] * b[0], a[0].apply(b[1]) + a[1]


def main():
    found, lidar, poses, weights = read(sys.argv[1])
    seen = split(poses["lidar"])
    roots = np.linalg.cholesky(weights).transpose(0, 2, 1)

    def pose(name, heading_s, tilt_s):
        """The pose some milliseconds from the latencies that were found: linear in both."""
        R0, t0 = split(poses[name + "0"])
        R, t = R0, t0.copy()
        for number, share in ((1, heading_s / LATENCY_STEP_S), (2, tilt_s / LATENCY_STEP_S)):
            R1, t1 = split(poses[name + str(number)])
            R = R * Rotation.from_rotvec(share * (R0.inv() * R1).as_rotvec())
            t += share * (t1 - t0)
        return R, t

    def residuals(x):
        turn = Rotation.from_rotvec(x[:3])
        D = (turn, lidar + x[5:] - turn.apply(lidar))
        begin = pose("begin", x[3] - found[3], x[4] - found[4])
        end = pose("end", x[3] - found[3], x[4] - found[4])
        expected = product(inverse(*D), product(product(inverse(*begin), end), D))
        rest = np.hstack([seen[1] - expected[1], (seen[0] * expected[0].inv()).as_rotvec()])
        white = np.einsum("nij,nj->ni", roots, rest)
        # Cauchy's function of a pair as a whole, as the factor that makes its squares so large.
        squares = (white**2).sum(axis=1) / 6.0 + 1e-12
        white *= np.sqrt(CAUCHY**2 * np.log1p(squares / CAUCHY**2) / squares)[:, None]
        return np.hstack([white.ravel(), x / PRIOR_SD])

    start = np.zeros(8)
    start[3:5] = found[3:5] + 0.003
    fit = least_squares(residuals, start, x_scale=np.array([1e-3] * 3 + [1e-3] * 2 + [1e-2] * 3), xtol=1e-10, ftol=1e-12)
    off = fit.x - found
    print(f"{len(seen[1])} pairs; scipy against lookout-calibrate: rotation {np.degrees(off[:3]).round(5)} deg, latency {(1e3 * off[3:5]).round(4)} ms, "
          f"place {(1e3 * off[5:]).round(3)} mm")
    if np.all(np.abs(off) <= TOLERANCE):
        return 0
    print(f"FAILED: scipy found {fit.x}, lookout-calibrate {found}")
    return 1


sys.exit(main())
