#!/usr/bin/env python3
"""Compares lookout-lidar with another decoder's point files, on captures of real sensors.

decoder_truth.py CLONE: CLONE is a clone of tier4/nebula (Apache-2.0), whose tests hold recordings of Hesai's and Velodyne's sensors (rosbag2) and the
points that its decoder made of one scan of each (PCD: x, y, z). Needs build/release/bin and Debian's python3-numpy and python3-scipy. Nothing of the
clone is kept.

Of each sensor it tells how many points have a return of ours at the same place: Hesai by x, y, z. Of Velodyne by ring and range alone, and how far
the azimuths differ: that decoder leaves out by how much the head turns between the lasers of a block.
"""
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from scipy.spatial import cKDTree

# Sensor: model of lidar.txtpb, folder of its recording, file of its beams.
HESAI = {
    "Pandar40P": ("MODEL_PANDAR40P", "40p", "Pandar40P.csv"),
    "Pandar64": ("MODEL_PANDAR64", "64", "Pandar64.csv"),
    "QT64": ("MODEL_QT64", "qt64", "PandarQT64.csv"),
    "QT128": ("MODEL_QT128", "qt128", "PandarQT128.csv"),
    "XT16": ("MODEL_XT16", "xt16", "PandarXT16.csv"),
    "XT32": ("MODEL_XT32", "xt32", "PandarXT32.csv"),
    "XT32M": ("MODEL_XT32M", "xt32m", "PandarXT32M.csv"),
}
VELODYNE = {"VLS-128": ("MODEL_VLS128", "vls128", None), "VLP-32C": ("MODEL_VLP32C", "vlp32", None)}
SAME_M = 0.001


def points_of(file):
    """x, y, z of a binary PCD file."""
    data = file.read_bytes()
    begin = data.index(b"\n", data.index(b"DATA binary")) + 1
    header = dict(line.split(" ", 1) for line in data[:begin].decode().splitlines() if " " in line)
    layout = np.dtype([(f"{name}{i}", {"F": "f", "U": "u", "I": "i"}[kind] + size) for i, (name, size, kind) in
                       enumerate(zip(header["FIELDS"].split(), header["SIZE"].split(), header["TYPE"].split()))])
    points = np.frombuffer(data, layout, int(header["POINTS"]), begin)
    return np.stack([points[name].astype(float) for name in layout.names[:3]], axis=1)


def returns_of(folder, model, beam_file, recording):
    """Ring, azimuth (deg, clockwise), range (m), x, y, z of every return."""
    config = f"model: {model} position_port: 10110\n"
    if beam_file:
        (folder / "angles.csv").write_bytes(beam_file.read_bytes())
        config += 'beam_file: "angles.csv"\n'
    (folder / "lidar.txtpb").write_text(config)
    (folder / "boat.txtpb").write_text(pathlib.Path("config/demo/boat.txtpb").read_text())

    def run(program, *words):
        subprocess.run([f"build/release/bin/lookout-{program}", *words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    run("import", "--config", folder, "--in", recording, "--out", folder / "packets")
    run("replay", "--config", folder, "--only", "lidar", "--in", folder / "packets", "--out", folder / "scans")
    run("export", "--in", folder / "scans", "--table", "returns", "--out", folder / "returns.csv")
    returns = np.genfromtxt(folder / "returns.csv", delimiter=",", skip_header=1, usecols=(2, 4, 5, 6, 7, 8))
    return returns[np.isfinite(returns).all(axis=1)]


def compare_places(points, returns):
    # That decoder has y ahead and x to starboard; the lidar's frame here has x ahead and y to port.
    distance_m, _ = cKDTree(returns[:, 3:]).query(np.stack([points[:, 1], -points[:, 0], points[:, 2]], axis=1))
    return f"{np.mean(distance_m < SAME_M):.6f} of the points are ours, farthest {1000 * distance_m.max():.2f} mm"


def in_one_space(range_m, azimuth_rad):
    """A range that differs by a step is far, an azimuth by a degree near."""
    return np.stack([range_m / SAME_M, 60 * np.cos(azimuth_rad), 60 * np.sin(azimuth_rad)], axis=1)


def compare_rings(points, returns):
    range_m = np.linalg.norm(points, axis=1)
    elevation_rad = np.arcsin(points[:, 2] / range_m)
    azimuth_rad = np.arctan2(-points[:, 1], points[:, 0])
    rings = np.unique(returns[:, 0])
    of_ring_rad = np.array([np.median(np.arcsin(returns[returns[:, 0] == ring, 5] / np.linalg.norm(returns[returns[:, 0] == ring, 3:], axis=1)))
                            for ring in rings])
    nearest = np.abs(elevation_rad[:, None] - of_ring_rad[None, :]).argmin(axis=1)
    apart_deg, num_same = [], 0
    for i, ring in enumerate(rings):
        ours = returns[returns[:, 0] == ring]
        theirs = nearest == i
        if not theirs.any():
            continue
        _, found = cKDTree(in_one_space(ours[:, 2], np.radians(ours[:, 1]))).query(in_one_space(range_m[theirs], azimuth_rad[theirs]))
        is_same = np.abs(ours[found, 2] - range_m[theirs]) < SAME_M
        num_same += is_same.sum()
        apart_deg.append(np.abs((np.degrees(azimuth_rad[theirs]) - ours[found, 1] + 180) % 360 - 180)[is_same])
    off_rad = np.abs(elevation_rad - of_ring_rad[nearest])
    return (f"{num_same / len(points):.6f} of the points are ours by ring and range, elevation to {np.degrees(off_rad.max()):.5f} deg, "
            f"azimuth to {np.concatenate(apart_deg).max():.3f} deg")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    clone = pathlib.Path(sys.argv[1])
    for sensor, (model, name, beams) in {**HESAI, **VELODYNE}.items():
        folder = next(clone.glob(f"src/*/*/test_resources/decoder_ground_truth/{name}"))
        recording = next(path for path in sorted(folder.glob("*/*.db3")) if "all_points" not in path.name)
        points = points_of(next(folder.glob("*.pcd")))
        points = points[np.linalg.norm(points, axis=1) > 0.1]
        beam_file = next(clone.glob(f"src/*/*/calibration/{beams}")) if beams else None
        with tempfile.TemporaryDirectory() as made:
            returns = returns_of(pathlib.Path(made), model, beam_file, recording)
        result = (compare_rings if sensor in VELODYNE else compare_places)(points, returns)
        print(f"{sensor}: {len(points)} points of one scan, {len(returns)} returns of the recording: {result}")


main()
