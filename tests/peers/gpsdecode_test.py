"""Messages of AIS, value by value, as gpsd's gpsdecode has them: on lines that ais_lines makes, and on the files named by LOOKOUT_AIS_LINES.
   gpsdecode_test.py SOURCE_FOLDER BUILD_FOLDER"""

import collections
import json
import os
import subprocess
import sys

build = sys.argv[2]
gpsdecode = os.environ["LOOKOUT_GPSDECODE"]
lines_program = build + "/tests/ais_lines"
TYPES = {1, 2, 3, 4, 5, 9, 18, 19, 21, 24, 27}
KNOTS = {9: 1.0, 27: 1.0}  # units of speed where they are not tenths of a knot
# Of message 24 gpsdecode has both parts in one; ours are apart.
PART_B = {"shiptype", "callsign", "to_bow", "to_stern", "to_port", "to_starboard"}
faults = collections.Counter()


def run(command, text):
    return subprocess.run(command, input=text, capture_output=True, check=True).stdout.decode("ascii", "replace")


def peer_values(message):
    """gpsdecode's integers as our values; None: not available."""
    kind = message["type"]
    values = {"type": kind, "mmsi": message["mmsi"], "repeat": message["repeat"]}
    unit = 600.0 if kind == 27 else 600000.0
    if "lat" in message:
        is_place = abs(message["lat"]) <= 90 * unit and abs(message["lon"]) <= 180 * unit
        values["lat"] = message["lat"] / unit if is_place else None
        values["lon"] = message["lon"] / unit if is_place else None
        values["accuracy"] = int(message["accuracy"])
    if "speed" in message and kind != 21:
        scale = KNOTS.get(kind, 0.1)
        none = {9: 1023, 27: 63}.get(kind, 1023)
        values["speed"] = None if message["speed"] >= none else message["speed"] * scale
    if "course" in message:
        scale, none = (1.0, 360) if kind == 27 else (0.1, 3600)
        values["course"] = None if message["course"] >= none else message["course"] * scale
    if "heading" in message:
        values["heading"] = None if message["heading"] >= 360 else message["heading"]
    if "turn" in message:
        turn = message["turn"]
        values["turn_deg_min"] = None if abs(turn) >= 127 else (turn / 4.733) ** 2 * (1 if turn >= 0 else -1)
    if "second" in message:
        values["second"] = message["second"]
    if kind == 4:
        stamp = message["timestamp"]
        values["second"] = int(stamp[17:19])
    if "status" in message:
        values["status"] = message["status"]
    if kind == 21:
        values["virtual_aid"] = int(message["virtual_aid"])
        values["shipname"] = message["name"]
    for name in ("shipname", "callsign", "shiptype"):
        if name in message:
            values[name] = message[name]
    # gpsdecode joins both parts of message 24.
    if "to_bow" in message:
        size = [message[name] for name in ("to_bow", "to_stern", "to_port", "to_starboard")]
        is_said = size[0] + size[1] > 0 and size[2] + size[3] > 0
        for name, metres in zip(("to_bow", "to_stern", "to_port", "to_starboard"), size):
            values[name] = metres if is_said else None
    return values


def same(one, other):
    if isinstance(one, str) or isinstance(other, str) or one is None or other is None:
        return one == other
    return abs(one - other) <= 1e-6 * max(1.0, abs(one))


def key(message):
    return message["mmsi"], message["type"]


def compare(name, text):
    ours = collections.defaultdict(list)
    for line in run([lines_program, "decode"], text).splitlines():
        message = json.loads(line)
        ours[key(message)].append(message)
    peers = collections.defaultdict(list)
    for line in run([gpsdecode, "-j", "-u", "-s"], text).splitlines():
        try:
            message = json.loads(line)
        except ValueError:
            faults["lines of gpsdecode that are no JSON"] += 1
            continue
        if message.get("class") == "AIS" and message["type"] in TYPES and message["mmsi"] > 0:
            peers[key(message)].append(message)
    num_values = num_differing = 0
    num_of_type = collections.Counter()
    missing = []
    for one in sorted(set(ours) | set(peers)):
        if len(ours[one]) != len(peers[one]):
            missing.append((one, len(ours[one]), len(peers[one])))
            continue
        for mine, raw in zip(ours[one], peers[one]):
            num_of_type[raw["type"]] += 1
            is_part_b = not PART_B.isdisjoint(mine)
            for field, value in peer_values(raw).items():
                if field not in mine:
                    if raw["type"] == 24 and (field in PART_B) != is_part_b:
                        continue
                    faults["lacks " + field] += 1
                    num_differing += 1
                    continue
                num_values += 1
                if not same(mine[field], value):
                    num_differing += 1
                    print(f"{name}: type {raw['type']} of {raw['mmsi']}: {field} is {mine[field]!r}, gpsdecode has {value!r}")
    for one, num_ours, num_peers in missing[:20]:
        print(f"{name}: type {one[1]} of {one[0]}: {num_ours} times, gpsdecode {num_peers} times")
    print(f"{name}: {num_of_type.total()} messages, {num_values} values, {num_differing} differ; {len(missing)} senders and types with other numbers of messages")
    return num_of_type, num_differing, len(missing)


num_bad = 0
for seed in (1, 2, 3):
    made = subprocess.run([lines_program, "make", str(seed), "11000"], capture_output=True, check=True).stdout
    num_of_type, num_differing, num_missing = compare(f"made lines, seed {seed}", made)
    too_few = [kind for kind in TYPES if num_of_type[kind] < 500]
    if too_few:
        print(f"made lines, seed {seed}: hardly any of the types {too_few}")
    num_bad += num_differing + num_missing + len(too_few)
for path in os.environ.get("LOOKOUT_AIS_LINES", "").split():
    with open(path, "rb") as file:
        # Messages that only one of both takes are printed.
        num_bad += compare(os.path.basename(path), file.read())[1]
print(dict(faults))
sys.exit(1 if num_bad or faults else 0)
