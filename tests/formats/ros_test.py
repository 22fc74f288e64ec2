#!/usr/bin/env python3
"""Bags that rosbag writes, and MCAP files and messages of ROS 2 that the libraries of MCAP and Foxglove write, are imported: the lidar's packets are
those of the capture, byte for byte, and all else is what was written.
  ros_test.py SOURCE_FOLDER BUILD_FOLDER NPM_FOLDER"""
import base64
import json
import math
import pathlib
import re
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile

import genpy
import numpy as np
import pandas
import rosbag

import logs
import ros_types
from logs import digest, events

source, build, npm = (pathlib.Path(argument) for argument in sys.argv[1:4])
here = source / 'tests/formats'
bin_folder = build / 'bin'
config = source / 'config/demo'
work = pathlib.Path(tempfile.mkdtemp(prefix='lookout_ros_'))
NS = 10**9
POINTS = {  # by driver: name, type of numpy
    'velodyne': [('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('intensity', '<f4'), ('ring', '<u2'), ('time', '<f4')],
    'ouster': [('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('', '<f4'), ('intensity', '<f4'), ('t', '<u4'), ('reflectivity', '<u2'), ('ring', 'u1'),
               ('', 'u1'), ('ambient', '<u2'), ('', '<u2'), ('range', '<u4')],
    'hesai': [('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('intensity', '<f4'), ('timestamp', '<f8'), ('ring', '<u2')]}
FIELD_TYPES = {'u1': 2, '<u2': 4, '<u4': 6, '<f4': 7, '<f8': 8}


def run(program, *arguments):
    return logs.run(bin_folder, program, *arguments)


def node(script, *arguments, **options):
    shutil.copy(here / script, npm)  # where its packages are
    return subprocess.run(['node', str(npm / script), *map(str, arguments)], check=True, capture_output=True, text=True, **options).stdout


def frames(pcap):
    data = pcap.read_bytes()
    unit_ns = 1 if struct.unpack_from('<I', data)[0] == 0xA1B23C4D else 1000
    at = 24
    while at < len(data):
        seconds, parts, size = struct.unpack_from('<III', data, at)
        frame = data[at + 16:at + 16 + size]
        begin = 14 + (frame[14] & 15) * 4
        yield seconds * NS + parts * unit_ns, struct.unpack_from('>H', frame, begin + 2)[0], frame[begin + 8:], data[at:at + 16 + size]
        at += 16 + size


def stamp(time_ns):
    return {'sec': time_ns // NS, 'nanosec': time_ns % NS}


def header(time_ns):
    return {'stamp': stamp(time_ns), 'frame_id': 'lidar'}


def cloud(driver, points, begin_us):
    """A turn as its driver would send it."""
    names, fields, offset = [], [], 0
    for name, kind in POINTS[driver]:
        if name:
            names.append((name, kind, offset))
            fields.append({'name': name, 'offset': offset, 'datatype': FIELD_TYPES[kind], 'count': 1})
        offset += np.dtype(kind).itemsize
    layout = np.dtype({'names': [n for n, _, _ in names], 'formats': [k for _, k, _ in names], 'offsets': [o for _, _, o in names], 'itemsize': offset})
    points = points.sort_values('utime_us', kind='stable')
    since_us = (points.utime_us - begin_us).to_numpy()
    if driver == 'ouster':  # rows are rings from the top, columns are firings; what has no return is at the origin
        column = np.floor((since_us + 3) / 55.296).astype(int)
        made = np.zeros((16, column.max() + 1), layout)
        made['ring'] = np.arange(16)[:, None]
        made['t'] = (np.arange(column.max() + 1) * 55296)[None, :]
        place = (15 - points.ring.to_numpy(), column)
    else:
        made = np.zeros((1, len(points)), layout)
        place = (np.zeros(len(points), int), np.arange(len(points)))
        made['ring'][place] = points.ring
    for axis in 'xyz':
        made[axis][place] = points[f'{axis}_m']
    made['reflectivity' if driver == 'ouster' else 'intensity'][place] = points.reflectivity
    if driver == 'velodyne':
        made['time'][place] = since_us * 1e-6
    if driver == 'hesai':
        made['timestamp'][place] = points.utime_us * 1e-6
    height, width = made.shape
    return {'header': header(int(begin_us) * 1000), 'height': height, 'width': width, 'fields': fields, 'is_bigendian': False, 'point_step': offset,
            'row_step': offset * width, 'data': list(made.tobytes()), 'is_dense': True}


def make_messages(pcap, returns):
    """(topic, type, time in ns, message) in the order of time."""
    messages, packets, fix = [], [], 0
    for time_ns, port, payload, _ in frames(pcap):
        if port == 2368:
            packets.append({'stamp': stamp(time_ns), 'data': list(payload)})
            if len(packets) == 76:
                messages.append(('/velodyne_packets', 'velodyne_msgs/VelodyneScan', time_ns, {'header': header(time_ns), 'packets': packets}))
                packets = []
        elif port == 10110:
            for line in payload.decode('ascii').split():
                messages.append(('/nmea_sentence', 'nmea_msgs/Sentence', time_ns, {'header': header(time_ns), 'sentence': line}))
                if not re.match(r'\$..GGA', line):
                    continue
                covariance = [0.04, 0.0, 0.0, 0.0, 0.09, 0.0, 0.0, 0.0, 0.25]
                messages.append(('/gps/fix', 'sensor_msgs/NavSatFix', time_ns,
                                 {'header': header(time_ns), 'status': {'status': 0, 'service': 1}, 'latitude': -43.70001234567 + 1e-6 * fix,
                                  'longitude': 170.1001234567, 'altitude': 710.125, 'position_covariance': covariance, 'position_covariance_type': 2}))
                vector = {'x': 0.0, 'y': 0.0, 'z': 0.0}
                messages.append(('/gps/vel', 'geometry_msgs/TwistStamped', time_ns,
                                 {'header': header(time_ns), 'twist': {'linear': {'x': 1.5, 'y': -2.0, 'z': 0.1}, 'angular': vector}}))
                fix += 1
    last_ns = messages[-1][2]
    if packets:
        messages.append(('/velodyne_packets', 'velodyne_msgs/VelodyneScan', last_ns, {'header': header(last_ns), 'packets': packets}))
    first_ns = messages[0][2]
    for time_ns in range(first_ns, last_ns, NS // 100):
        zeros = [0.0] * 9
        messages.append(('/imu/data', 'sensor_msgs/Imu', time_ns,
                         {'header': header(time_ns), 'orientation': {'x': 0.0, 'y': 0.0, 'z': 0.0, 'w': 1.0}, 'orientation_covariance': zeros,
                          'angular_velocity': {'x': 0.01, 'y': 0.02, 'z': 0.03}, 'angular_velocity_covariance': zeros,
                          'linear_acceleration': {'x': 0.1, 'y': 0.2, 'z': 9.8}, 'linear_acceleration_covariance': zeros}))
    for begin_us, points in returns.groupby('scan_utime_us'):
        for driver in POINTS:
            messages.append((f'/{driver}/points', 'sensor_msgs/PointCloud2', int(begin_us) * 1000 + NS // 10, cloud(driver, points, begin_us)))
    return sorted(messages, key=lambda message: message[2])


def fill(target, value):
    """Values into a message of ROS 1."""
    for name, part in value.items():
        if name == 'stamp':
            target.stamp = genpy.Time(part['sec'], part['nanosec'])
        elif isinstance(part, dict):
            fill(getattr(target, name), part)
        elif isinstance(part, list) and part and isinstance(part[0], dict):
            classes = ros_types.generated(target._type)
            kind = next(c for n, c in classes.items() if n.split('/')[1] == {'packets': 'VelodynePacket', 'fields': 'PointField'}[name])
            setattr(target, name, [fill(kind(), one) for one in part])
        elif name == 'data':
            target.data = bytes(part)
        else:
            setattr(target, name, part)
    return target


def write_bags(messages):
    made = [(topic, fill(ros_types.generated(kind)[kind](), message), genpy.Time(time_ns // NS, time_ns % NS)) for topic, kind, time_ns, message in messages]
    for compression in ('none', 'bz2', 'lz4'):
        with rosbag.Bag(str(work / f'{compression}.bag'), 'w', compression=compression) as bag:
            for topic, message, time in made:
                bag.write(topic, message, time)
    return [work / f'{compression}.bag' for compression in ('none', 'bz2', 'lz4')]


def write_ros2(messages):
    (work / 'types.json').write_text(json.dumps(ros_types.ros2_texts()))
    lines = ''.join(json.dumps({'topic': t, 'type': k, 'time': str(n), 'message': m}) + '\n' for t, k, n, m in messages)
    cdr = [json.loads(line) for line in node('write_ros2.mjs', work / 'types.json', work, input=lines).splitlines()]
    folder = work / 'rosbag2'
    folder.mkdir()
    topics = {}
    for part, rows in enumerate((cdr[:len(cdr) // 2], cdr[len(cdr) // 2:])):
        database = sqlite3.connect(folder / f'rosbag2_{part}.db3')
        database.executescript('CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL,'
                               ' offered_qos_profiles TEXT NOT NULL);'
                               'CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);'
                               'CREATE INDEX timestamp_idx ON messages (timestamp ASC);')
        for row in rows:
            topics.setdefault(row['topic'], (len(topics) + 1, row['type'].replace('/', '/msg/')))
        database.executemany("INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')", [(number, name, kind) for name, (number, kind) in topics.items()])
        for row in rows:
            data = base64.b64decode(row['cdr'])
            if part == 1 and row['topic'] == '/velodyne_packets':  # compression_mode: message
                data = subprocess.run(['zstd', '-q', '-c'], input=data, check=True, capture_output=True).stdout
            database.execute('INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)', (topics[row['topic']][0], int(row['time']), data))
        database.commit()
        database.close()
    return [work / f'{compression}.mcap' for compression in ('none', 'lz4', 'zstd')] + [folder]


def nav_items(log):
    """Of NAV_RAW: (kind, source, sentence, IMU)."""
    items = []
    for channel, payload in events(log):
        if channel != 'NAV_RAW':
            continue
        _, kind = struct.unpack_from('>qi', payload, 16)
        at, texts = 28, []
        for _ in range(2):
            size = struct.unpack_from('>i', payload, at)[0]
            texts.append(payload[at + 4:at + 3 + size].decode())
            at += 4 + size
        count = struct.unpack_from('>i', payload, at)[0]
        items.append((kind, *texts, struct.unpack_from('>6d', payload, at + 4) if count else ()))
    return items


def check_points(returns, log, driver):
    table = work / 'points.csv'
    run('export', '--in', log, '--table', 'returns', '--out', table, '--force')
    made = pandas.read_csv(table)
    assert made.scan_utime_us.nunique() == returns.scan_utime_us.nunique(), driver
    assert len(made) == len(returns), f'{driver}: {len(made)} returns of {len(returns)}'
    # Of each scan and ring in the order of their turn.
    turns = {}
    for name, all_returns in (('before', returns), ('after', made)):
        number = all_returns.scan_utime_us.rank(method='dense').astype(int)
        keys = all_returns.assign(scan=number).sort_values(['scan', 'ring', 'utime_us'], kind='stable')
        turns[name] = keys[['scan', 'ring', 'x_m', 'y_m', 'z_m', 'reflectivity', 'utime_us']].to_numpy()
    off = turns['after'] - turns['before']
    assert (off[:, :2] == 0).all() and (off[:, 5] == 0).all(), driver
    distance_m = np.sqrt((off[:, 2:5]**2).sum(axis=1))
    print(f'{driver}: {len(made)} returns, off by {np.median(distance_m):.4f} m (median), {distance_m.max():.4f} m (greatest),'
          f' {np.abs(off[:, 6]).max():.0f} us')
    assert distance_m.max() < 0.02, driver
    assert np.abs(off[:, 6]).max() <= (40 if driver == 'ouster' else 5), driver  # columns of that cloud have one time


def main():
    pcap = work / 'sim.pcap'
    run('sim', '--config', config, '--scene', 'lake', '--seed', '2', '--seconds', '3', '--pcap', pcap)
    lidar = work / 'lidar.pcap'
    lidar.write_bytes(pcap.read_bytes()[:24] + b''.join(raw for _, port, _, raw in frames(pcap) if port == 2368))
    run('replay', '--config', config, '--in', lidar, '--out', work / 'lidar.lcmlog')
    wanted = digest(work / 'lidar.lcmlog', 'LIDAR_PACKETS')
    run('export', '--in', work / 'lidar.lcmlog', '--table', 'returns', '--out', work / 'returns.csv')
    returns = pandas.read_csv(work / 'returns.csv')
    messages = make_messages(pcap, returns)
    counts = {}
    for topic, *_ in messages:
        counts[topic] = counts.get(topic, 0) + 1

    bags = write_bags(messages)
    for bag in bags:
        theirs = json.loads(node('count_bag.mjs', bag))
        assert {topic: count for topic, (count, *_) in theirs.items()} == counts, bag
    sentences = [m['sentence'] for t, _, _, m in messages if t == '/nmea_sentence']
    fixes = ('/gps/fix fix\n/gps/vel velocity time=recorded\n/imu/data imu\n')
    for recording in bags + write_ros2(messages):
        listed = run('import', '--in', recording, '--list')
        if not recording.is_dir():
            assert {line.split()[0]: int(line.split()[-2]) for line in listed.splitlines() if 'messages' in line} == (counts if recording.suffix != '.db3' else {}), listed
        log = work / 'out.lcmlog'
        told = run('import', '--config', config, '--in', recording, '--out', log, '--force')
        assert digest(log, 'LIDAR_PACKETS') == wanted, f'{recording}: {told}'
        items = nav_items(log)
        assert [s for _, source_name, s, _ in items if source_name == 'imported:/nmea_sentence'] == sentences, recording
        samples = [imu for *_, imu in items if imu]
        assert len(samples) == counts['/imu/data'] and samples[0] == (0.01, -0.02, -0.03, 0.1, -0.2, -9.8), samples[:1]
        assert items[0][0] == 0 and items[-1][0] == 4, recording
        run('replay', '--config', config, '--in', log, '--out', work / 'again.lcmlog', '--force')
        # Positions and velocities as sentences, and IMU samples as they are.
        topics = work / 'topics.txt'
        topics.write_text(fixes)
        run('import', '--config', config, '--in', recording, '--out', log, '--topics', topics, '--force')
        items = nav_items(log)
        gga = [s.split(',') for _, name, s, _ in items if name == 'imported:/gps/fix' and s.startswith('$GPGGA')]
        assert len(gga) == counts['/gps/fix'], recording
        for number, fields in enumerate(gga):
            latitude = int(fields[2][:2]) + float(fields[2][2:]) / 60
            assert fields[3] == 'S' and math.isclose(latitude, 43.70001234567 - 1e-6 * number, abs_tol=2e-10), fields
            assert math.isclose(float(fields[9]) + float(fields[11]), 710.125), fields
        assert [s.split('*')[0].split(',')[6:] for _, _, s, _ in items if s.startswith('$GPGST')][0] == ['0.3000', '0.2000', '0.5000']
        vtg = [s.split(',') for _, name, s, _ in items if name == 'imported:/gps/vel'][0]
        assert math.isclose(float(vtg[1]), math.degrees(math.atan2(1.5, -2.0)), abs_tol=1e-4) and math.isclose(float(vtg[7]), 2.5 * 3.6), vtg
        assert [imu for *_, imu in items if imu][0] == (0.01, 0.02, 0.03, 0.1, 0.2, 9.8)
        run('replay', '--config', config, '--in', log, '--out', work / 'again.lcmlog', '--force')
        for driver in POINTS:
            topics.write_text(f'# a lidar and its boat\n/{driver}/points lidar_scan\n/nmea_sentence sentences\n')
            run('import', '--config', config, '--in', recording, '--out', log, '--topics', topics, '--force')
            if recording.name in ('lz4.bag', 'zstd.mcap'):
                check_points(returns, log, driver)
        run('replay', '--config', config, '--from', 'LIDAR_SCAN', '--in', log, '--out', work / 'again.lcmlog', '--force')
        assert sum(channel == 'OBSTACLES' for channel, _ in events(work / 'again.lcmlog')) > 20, recording
        print(f'{recording.name}: as it was written')
    shutil.rmtree(work)


main()
