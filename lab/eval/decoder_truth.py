#!/usr/bin/env python3
"""Compares lookout-lidar with another decoder's point files, on captures of real sensors.

decoder_truth.py CLONE: CLONE is a clone of tier4/nebula (Apache-2.0), whose tests hold recordings of Hesai's and Velodyne's sensors (rosbag2) and the
points that its decoder made of one scan of each (PCD: x, y, z). Needs build/release/bin and Debian's python3-numpy and python3-scipy. Nothing of the
clone is kept.

Of each sensor it tells how many points have a return of ours at the same place: Hesai by x, y, z. Of Velodyne by ring and range alone, and how far
the azimuths differ: that decoder leaves out by how much the head turns between the lasers of a block.
"""
import pathlib
import sqlite3
import struct
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
PANDAR_BYTES = 1500
VELODYNE_BYTES = 1206


class Cdr:
    """Reads a message of ROS 2."""

    def __init__(self, data):
        self.data, self.at = data, 4  # behind the encapsulation header, from which alignment counts

    def number(self, form):
        size = struct.calcsize(form)
        self.at += (4 - self.at) % size
        (value,) = struct.unpack_from("<" + form, self.data, self.at)
        self.at += size
        return value

    def take(self, size):
        self.at += size
        return self.data[self.at - size : self.at]


def packets_of(data, kind):
    """(time in s, bytes) of each packet of one message."""
    message = Cdr(data)
    message.number("i"), message.number("I")
    message.take(message.number("I"))
    for _ in range(message.number("I")):
        time = message.number("i") + 1e-9 * message.number("I")
        if "velodyne" in kind:
            yield time, message.take(VELODYNE_BYTES)
        elif "pandar" in kind:
            packet = message.take(PANDAR_BYTES)
            yield time, packet[: message.number("I")]
        else:
            yield time, message.take(message.number("I"))


def write_capture(recording, file):
    """Raw IPv4 with UDP to port 2368. No checksums: the reader needs none."""
    connection = sqlite3.connect(recording)
    (kind,) = connection.execute("SELECT type FROM topics").fetchone()
    with open(file, "wb") as out:
        out.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 101))
        for (data,) in connection.execute("SELECT data FROM messages ORDER BY timestamp"):
            for time, packet in packets_of(data, kind):
                udp = struct.pack(">HHHH", 2368, 2368, 8 + len(packet), 0) + packet
                frame = struct.pack(">BBHIBBH", 0x45, 0, 20 + len(udp), 0, 64, 17, 0) + bytes([192, 168, 1, 201, 192, 168, 1, 100]) + udp
                out.write(struct.pack("<IIII", int(time), int(time % 1 * 1e6), len(frame), len(frame)) + frame)


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
    write_capture(recording, folder / "capture.pcap")
    config = f'source: CAPTURE capture_file: "{folder}/capture.pcap" model: {model} position_port: 10110\n'
    if beam_file:
        (folder / "angles.csv").write_bytes(beam_file.read_bytes())
        config += 'beam_file: "angles.csv"\n'
    (folder / "lidar.txtpb").write_text(config)
    (folder / "boat.txtpb").write_text(pathlib.Path("config/demo/boat.txtpb").read_text())
    run = lambda *words: subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    run("build/release/bin/lookout-replay", "--config", folder, "--only", "lidar", "--in", folder / "capture.pcap", "--out", folder / "log")
    run("build/release/bin/lookout-export", "--in", folder / "log", "--table", "returns", "--out", folder / "returns.csv")
    returns = np.genfromtxt(folder / "returns.csv", delimiter=",", skip_header=1, usecols=(2, 4, 5, 6, 7, 8))
    return returns[np.isfinite(returns).all(axis=1)]


def compare_places(points, returns):
    # That decoder has y ahead and x to starboard; the lidar's frame here has x ahead and y to port.
    distance_m, _ = cKDTree(returns[:, 3:]).query(np.stack([points[:, 1], -points[:, 0], points[:, 2]], axis=1))
    return f"{np.mean(distance_m < SAME_M):.6f} of the points are ours, farthest {1000 * distance_m.max():.2f} mm"


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
        # In one space: a range that differs by a step is far.
        place = lambda m, rad: np.stack([m / SAME_M, 60 * np.cos(rad), 60 * np.sin(rad)], axis=1)
        _, found = cKDTree(place(ours[:, 2], np.radians(ours[:, 1]))).query(place(range_m[theirs], azimuth_rad[theirs]))
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
