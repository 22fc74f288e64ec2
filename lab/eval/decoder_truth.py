#!/usr/bin/env python3
"""Compares lookout-lidar with other decoders, on captures of real sensors.

decoder_truth.py CLONE: a clone of tier4/nebula (Apache-2.0) or of ouster-lidar/ouster-sdk (BSD-3). Needs build/release/bin and Debian's python3-numpy
and python3-scipy. Nothing of the clone is kept.

nebula: its tests hold recordings of Hesai's and Velodyne's sensors (rosbag2) and the points that its decoder made of one scan of each (PCD: x, y, z).
Of each sensor it is told how many points have a return of ours at the same place: Hesai by x, y, z. Of Velodyne by ring and range alone, and how far
the azimuths differ: that decoder leaves out by how much the head turns between the lasers of a block.

ouster-sdk: its tests hold captures with the MD5 of the scan's ranges. The packets that lookout-lidar logged must give it, and the scan that it made must
hold those ranges, to half of its unit.
"""
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from scipy.spatial import cKDTree

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "python"))
import lookout

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


def run(program, *words):
    subprocess.run([f"build/release/bin/lookout-{program}", *words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def configure(folder, lines, beam_file):
    if beam_file:
        (folder / "beams").write_bytes(beam_file.read_bytes())
        lines += ' beam_file: "beams"'
    (folder / "lidar.txtpb").write_text(lines + "\n")
    (folder / "boat.txtpb").write_text(pathlib.Path("config/demo/boat.txtpb").read_text())


def returns_of(folder, model, beam_file, recording):
    """Ring, azimuth (deg, clockwise), range (m), x, y, z of every return."""
    configure(folder, f"model: {model} position_port: 10110", beam_file)
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


# Bytes of a packet's head, of a column's head and tail and of a pixel, the bits of its range, and their unit in mm.
LAYOUTS = {None: (0, 16, 4, 12, 0xFFFFF, 1), "RNG19_RFL8_SIG16_NIR16": (32, 12, 0, 12, 0x7FFFF, 1),
           "RNG19_RFL8_SIG16_NIR16_DUAL": (32, 12, 0, 16, 0x7FFFF, 1), "RNG15_RFL8_NIR8": (32, 12, 0, 4, 0x7FFF, 8)}


def compare_digest(folder, capture, metadata_file):
    metadata = json.loads(metadata_file.read_text())
    layout = metadata.get("lidar_data_format") or metadata["data_format"]
    beams = metadata.get("beam_intrinsics", metadata)["beam_altitude_angles"]
    head, column_head, tail, pixel, mask, unit_mm = LAYOUTS[layout.get("udp_profile_lidar")]
    configure(folder, f'model: MODEL_OUSTER source: CAPTURE capture_file: "{capture.resolve()}" data_port: 7502 position_port: 7503', metadata_file)
    run("replay", "--config", folder, "--only", "lidar", "--in", capture, "--out", folder / "scans")
    range_mm = np.zeros((len(beams), layout["columns_per_frame"]), np.uint32)
    column_bytes = column_head + pixel * len(beams) + tail
    for _, message in lookout.messages(folder / "scans", "LIDAR_PACKETS"):
        payload, begin = bytes(np.asarray(message.payload, np.uint8)), 0
        for port, size in zip(message.udp_port, message.size_bytes):
            packet, begin = payload[begin : begin + size], begin + size
            for k in range(layout["columns_per_packet"] if port == 7502 else 0):
                at = head + k * column_bytes
                words = [int.from_bytes(packet[at + column_head + pixel * i :][:4], "little") for i in range(len(beams))]
                range_mm[:, int.from_bytes(packet[at + 8 : at + 10], "little")] = [(word & mask) * unit_mm for word in words]
    digest = hashlib.md5(range_mm.tobytes()).hexdigest()
    off, num_returns = 0.0, 0
    from_below = np.argsort(beams, kind="stable")
    for _, scan in lookout.messages(folder / "scans", "LIDAR_SCAN"):
        cells = np.asarray(scan.range, np.uint16).reshape(-1, scan.num_rings, scan.num_returns)[:, :, 0] * (1000 * scan.range_unit_m)
        columns = np.round(np.asarray(scan.azimuth_rad) / (2 * np.pi) * range_mm.shape[1]).astype(int) % range_mm.shape[1]
        off = max(off, np.abs(cells - range_mm[from_below][:, columns].T).max() / (1000 * scan.range_unit_m))
        num_returns += np.count_nonzero(cells)
    return digest, f"{num_returns} of {np.count_nonzero(range_mm)} ranges in LIDAR_SCAN, off by {off:.2f} of its unit at most"


def compare_ouster(clone):
    for digest_file in sorted(clone.glob("tests/pcaps/*_digest.json")):
        name = digest_file.name.removesuffix("_digest.json")
        with tempfile.TemporaryDirectory() as made:
            digest, scan = compare_digest(pathlib.Path(made), digest_file.with_name(name + ".pcap"), digest_file.with_name(name + ".json"))
        wanted = json.loads(digest_file.read_text())["scans"][0]["RANGE"]
        print(f"{name}: MD5 of its ranges {'equal' if digest == wanted else 'DIFFERENT'}; {scan}")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    clone = pathlib.Path(sys.argv[1])
    if (clone / "tests/pcaps").is_dir():
        return compare_ouster(clone)
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
