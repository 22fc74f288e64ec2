"""The package `lookout`: types as the programs have them, logs read and written, damage, tables as lookout-export writes them.
  python_package_test.py FOLDER_OF_PROGRAMS LOG FINGERPRINTS WORK_FOLDER"""
import csv
import pathlib
import subprocess
import sys

import numpy

import lookout

programs, log, fingerprints, work = (pathlib.Path(argument) for argument in sys.argv[1:5])

known = {}
for line in fingerprints.read_text().splitlines():
    if line.strip() and not line.startswith('#'):
        name, number = line.split()[:2]
        known[name] = int(number, 16)
assert {made.type_name: made.fingerprint for made in lookout.message_types if made.type_name in known} == known

# Each message as it was, and the log byte for byte.
channels = {}
with lookout.LogReader(log) as reader, lookout.LogWriter(work / 'copy.lcmlog') as writer:
    for event in reader:
        made = lookout.message_types.by_fingerprint(int.from_bytes(event.data[:8], 'big'))
        message = made.decode(event.data)
        assert message.encode() == event.data, event.channel
        writer.write(event.time_us, event.channel, message)
        channels[event.channel] = channels.get(event.channel, 0) + 1
    assert reader.num_damaged == 0
assert (work / 'copy.lcmlog').read_bytes() == log.read_bytes()
assert {'RUN_INFO', 'LIDAR_SCAN', 'OBSTACLES', 'POSE', 'TRACKS'} <= set(channels)
try:
    lookout.LogWriter(work / 'copy.lcmlog')
    raise AssertionError('a log was written over')
except FileExistsError:
    pass

# The types as they stand in the log.
of_log = lookout.types_of_log(log)
assert of_log is not lookout.message_types and {t.fingerprint for t in of_log} == {t.fingerprint for t in lookout.message_types}

# Cut and spoiled messages are none.
pose = next(event.data for event, _ in lookout.messages(log, 'POSE'))
for data in (b'', pose[:-1], pose + b'\0', b'\0' * len(pose)):
    try:
        lookout.message_types.pose_t.decode(data)
        raise AssertionError('is no message')
    except lookout.DecodeError:
        pass
scan = next(event.data for event, _ in lookout.messages(log, 'OBSTACLES'))
for place in range(8, len(scan), 97):
    for value in (0, 0x7F, 0xFF):
        spoiled = scan[:place] + bytes([value]) + scan[place + 1:]
        try:
            lookout.message_types.obstacles_t.decode(spoiled)
        except lookout.DecodeError:
            pass
try:
    lookout.message_types.lidar_scan_t(elevation_rad=numpy.zeros(3), azimuth_offset_rad=numpy.zeros(2)).encode()
    raise AssertionError('arrays of one count are not equally long')
except ValueError:
    pass

for wrong in ({'status': 2 ** 40 + 3}, {'covariance': []}):
    try:
        lookout.message_types.pose_t(**wrong).encode()
        raise AssertionError(f'{wrong} is encoded')
    except (ValueError, OverflowError):
        pass

# A damaged length that fits into the log loses its own event alone; the name of a channel may be longer than LCM sends; no time is beyond all years.
with lookout.LogWriter(work / 'small.lcmlog') as writer:
    for number in range(50):
        writer.write(1_700_000_000_000_000 + number, 'A', bytes(40))
small = bytearray((work / 'small.lcmlog').read_bytes())
size = len(small) // 50
small[10 * size + 24:10 * size + 28] = (40 + 5 * size + 7).to_bytes(4, 'big')
small[20 * size + 12:20 * size + 20] = (-2 ** 62).to_bytes(8, 'big', signed=True)
long_name = bytearray(small[:size])
long_name[20:28] = (300).to_bytes(4, 'big') + (0).to_bytes(4, 'big')
(work / 'small_damaged.lcmlog').write_bytes(small + long_name[:28] + b'B' * 300)
with lookout.LogReader(work / 'small_damaged.lcmlog') as reader:
    events = list(reader)
    assert reader.num_damaged == 2 and len(events) == 49 and events[-1].channel == 'B' * 300, (reader.num_damaged, len(events))
    assert {len(event.data) for event in events[:-1]} == {40}

# A damaged log: what stands before and after.
data = bytearray(log.read_bytes())
middle = len(data) // 2
data[middle:middle + 200] = b'\xAA' * 200
(work / 'damaged.lcmlog').write_bytes(data[:-3])
with lookout.LogReader(work / 'damaged.lcmlog') as reader:
    num_events = sum(1 for _ in reader)
    assert 1 <= reader.num_damaged <= 3 and sum(channels.values()) - 5 <= num_events < sum(channels.values()), (reader.num_damaged, num_events)


def exported(table):
    text = subprocess.run([str(programs / 'lookout-export'), '--in', str(log), '--table', table], check=True, capture_output=True, text=True).stdout
    return list(csv.DictReader(text.splitlines()))


rows = exported('obstacles')
obstacles = lookout.table(log, 'OBSTACLES', 'obstacles')
assert len(obstacles) == len(rows) == sum(message.num_obstacles for _, message in lookout.messages(log, 'OBSTACLES'))
assert numpy.allclose(obstacles['range_m'], [float(row['range_m']) for row in rows], atol=1e-3)
poses = lookout.table(log, 'POSE')
rows = exported('pose')
assert len(poses) == len(rows) and poses['covariance'].shape == (len(rows), 9, 9)
is_placed = numpy.isfinite(poses['latitude_deg'])
assert numpy.allclose(poses['latitude_deg'][is_placed], [float(row['latitude_deg']) for row in rows if row['latitude_deg']], atol=1e-9)
assert len(lookout.table(log, 'NONE')) == 0
all_points = numpy.concatenate([lookout.scan_points(message) for _, message in lookout.messages(log, 'LIDAR_SCAN')])
rows = exported('returns')
assert len(all_points) == len(rows)
for axis in ('x_m', 'y_m', 'z_m'):
    assert numpy.abs(all_points[axis] - [float(row[axis]) for row in rows]).max() < 6e-5


class Axes:
    """Takes what plot_scan draws, in place of matplotlib's."""

    def __init__(self):
        self.figure = self
        self.limits = []

    def scatter(self, x, y, c, **_):
        self.right_m, self.ahead_m, self.colours = x, y, c

    def set_title(self, text):
        self.title = text

    def set_xlim(self, *limits):
        self.limits.append(limits)

    set_ylim = set_xlim

    def __getattr__(self, _):
        return lambda *args, **options: None


_, scan = next(lookout.messages(log, 'LIDAR_SCAN'))
axes = lookout.plot_scan(scan, Axes(), 'range_m', 60)
points = lookout.scan_points(scan)
assert (axes.right_m == -points['y_m']).all() and (axes.ahead_m == points['x_m']).all() and (axes.colours == points['range_m']).all()
assert axes.title == f'scan {scan.seq}: {len(points)} returns' and axes.limits == [(-60, 60)] * 2
print(f'{sum(channels.values())} messages, {len(obstacles)} obstacles, {len(all_points)} returns')
