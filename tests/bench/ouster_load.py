#!/usr/bin/env python3
"""An Ouster of 128 rings and 2048 columns at 10 Hz, live: its datagrams on loopback into lookout-lidar, and lookout-segmenter behind it.

    ouster_load.py BUILD_FOLDER CONFIG_FOLDER [SECONDS] [dual]

Run it in a network namespace with a route for multicast on lo. Prints loss and share of a core of both processes, as HEALTH and /proc tell them. The
scene: water below, a wall at 60 m in a third of the circle, things at 8 to 80 m; noise in each range.
"""

import json
import os
import random
import re
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time

RINGS, COLUMNS, PER_PACKET, RATE = 128, 2048, 16, 10
PORT = 7502


def metadata(profile):
    """The maker's metadata of the sensor."""
    return json.dumps(
        {
            "prod_line": "OS-1-128",
            "lidar_mode": f"{COLUMNS}x{RATE}",
            "beam_altitude_angles": [22.0 - 44.0 * i / (RINGS - 1) for i in range(RINGS)],
            "beam_azimuth_angles": [(4.2, 1.4, -1.4, -4.2)[i % 4] for i in range(RINGS)],
            "lidar_origin_to_beam_origin_mm": 15.806,
            "data_format": {
                "columns_per_frame": COLUMNS,
                "columns_per_packet": PER_PACKET,
                "pixels_per_column": RINGS,
                "udp_profile_lidar": profile,
                "column_window": [0, COLUMNS - 1],
            },
        }
    )


def range_mm(rng, column, ring):
    """Of one shot; 0: no return."""
    azimuth_deg = 360.0 * column / COLUMNS
    elevation_deg = 22.0 - 44.0 * ring / (RINGS - 1)
    if abs(elevation_deg) < 6 and (azimuth_deg // 7) % 5 == 0:
        return int(8000 + 2000 * ((azimuth_deg // 7) % 37) + rng.gauss(0, 20))
    if 120 < azimuth_deg < 240 and -2 < elevation_deg < 8:
        return int(60000 + 5000 * ((azimuth_deg // 3) % 2) + rng.gauss(0, 20))
    if elevation_deg < -12 and rng.random() < 0.15:
        return int(1500 / -__import__("math").sin(elevation_deg * 3.14159 / 180) + rng.gauss(0, 30))
    return 0


def packets(is_dual):
    """One frame: 128 packets, with offsets of what changes from frame to frame."""
    rng = random.Random(1)
    made = []
    for first in range(0, COLUMNS, PER_PACKET):
        body = bytearray(32)
        struct.pack_into("<H", body, 0, 1)
        for column in range(first, first + PER_PACKET):
            body += struct.pack("<QHH", 0, column, 1)
            for ring in range(RINGS):
                distance = max(0, range_mm(rng, column, ring))
                if is_dual:
                    second = distance + 900 if distance and rng.random() < 0.1 else 0
                    body += struct.pack("<IIII", distance | 40 << 24, second | 20 << 24, 0, 0)
                else:
                    body += struct.pack("<IIHH", distance, 40, 0, 0)
        body += bytes(32)
        made.append(body)
    return made


def cpu_s(pid):
    """User and system time so far."""
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        words = file.read().rsplit(")", 1)[1].split()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def send(frames, made, column_bytes):
    """Each packet at its time. Returns how late the latest was."""
    out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    out.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 8 << 20)
    start = time.time()
    column_ns = 1_000_000_000 // (COLUMNS * RATE)
    latest = 0.0
    for frame in range(frames):
        for number, body in enumerate(made):
            due = start + (frame + (number + 1) / len(made)) / RATE
            now = time.time()
            if now < due:
                time.sleep(due - now)
            else:
                latest = max(latest, now - due)
            struct.pack_into("<H", body, 2, (frame + 1) & 0xFFFF)
            first_ns = int(start * 1e9) + (frame * COLUMNS + number * PER_PACKET) * column_ns
            for column in range(PER_PACKET):
                struct.pack_into("<Q", body, 32 + column * column_bytes, first_ns + column * column_ns)
            out.sendto(body, ("127.0.0.1", PORT))
    return latest


def main():
    """Starts the processes, sends, and prints."""
    build, config = os.path.abspath(sys.argv[1]), sys.argv[2]
    seconds = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    is_dual = "dual" in sys.argv
    made = packets(is_dual)
    column_bytes = 12 + RINGS * (16 if is_dual else 12)
    work = tempfile.mkdtemp(prefix="lookout_ouster_load.")
    folder = os.path.join(work, "config")
    shutil.copytree(config, folder)
    with open(os.path.join(folder, "metadata.json"), "w", encoding="ascii") as file:
        file.write(metadata("RNG19_RFL8_SIG16_NIR16_DUAL" if is_dual else "RNG19_RFL8_SIG16_NIR16"))
    with open(os.path.join(folder, "lidar.txtpb"), "w", encoding="ascii") as file:
        file.write(
            'source: UDP bind_address: "127.0.0.1" model: MODEL_OUSTER data_port: 7502 position_port: 7503 '
            'beam_file: "metadata.json" cut_azimuth_deg: 0 receive_buffer_bytes: 33554432\n'
        )
    os.chdir(work)
    processes = {}
    for name in ("recorder", "segmenter", "lidar"):
        with open(f"{name}.out", "w", encoding="ascii") as out:
            processes[name] = subprocess.Popen(
                [f"{build}/bin/lookout-{name}", "--config", folder], stdout=out, stderr=subprocess.STDOUT
            )
    time.sleep(3)
    before = {name: cpu_s(process.pid) for name, process in processes.items()}
    latest = send(seconds * RATE, made, column_bytes)
    shares = {name: 100 * (cpu_s(process.pid) - before[name]) / seconds for name, process in processes.items()}
    time.sleep(2.5)
    for name in ("lidar", "segmenter", "recorder"):
        processes[name].terminate()
        processes[name].wait()
        time.sleep(1.5)
    log = [name for name in os.listdir("logs") if name.endswith(".lcmlog")]
    print(f"{RINGS} x {COLUMNS} at {RATE} Hz, {'dual' if is_dual else 'single'}: {seconds * RATE * len(made)} packets of {len(made[0])} bytes sent, "
          f"the latest {1000 * latest:.0f} ms late")
    print("share of a core: " + ", ".join(f"{name} {share:.1f} %" for name, share in shares.items()))
    info = subprocess.run([f"{build}/bin/lookout-log", "info", *[os.path.join("logs", name) for name in log]], capture_output=True, text=True)
    print("\n".join(line for line in info.stdout.splitlines() if re.search("LIDAR|SEGMENTS|missing|lost|HEALTH", line)))
    clocks = subprocess.run(
        [f"{build}/bin/lookout-export", "--in", os.path.join("logs", log[0]), "--table", "clock"], capture_output=True, text=True
    ).stdout.splitlines()
    if len(clocks) > 1:
        row = dict(zip(clocks[0].split(","), clocks[-1].split(",")))
        print({key: row[key] for key in row if key.startswith("num_")})
    shutil.rmtree(work)


if __name__ == "__main__":
    main()
