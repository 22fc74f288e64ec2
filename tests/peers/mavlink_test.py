"""MAVLink 2 of lookout-plotter, decoded by node-mavlink: the distances that are true, and the bytes that node-mavlink would send itself."""
import json
import math
import os
import subprocess
import time

from plotter import Receiver, Trial, check, main

PLACE, SECONDS = (54.123456, 10.654321), 14
MAX_M, UNKNOWN = 120, 65535
CONFIG = '''
output { name: "sectors" format: MAVLINK udp { address: "127.0.0.1" port: 20021 } mavlink { max_distance_m: %d } }
output { name: "points" format: MAVLINK udp { address: "127.0.0.1" port: 20022 } mavlink { max_distance_m: %d form: POINTS system_id: 255 component_id: 1 } }
''' % (MAX_M, MAX_M)
# The distance is rounded down to whole centimetres, and coordinates go as single precision.
MOST_M = 0.0105


def decode(trial, datagrams):
    npm = os.path.join(trial.build, 'peers/npm')
    script = os.path.join(trial.source, 'tests/peers/decode_mavlink.cjs')
    run = subprocess.run(['node', script, npm], input=''.join(datagram.hex() + '\n' for datagram in datagrams), capture_output=True, text=True, check=True)
    messages = [json.loads(line) for line in run.stdout.splitlines()]
    check([message['line'] for message in messages] == list(range(len(datagrams))), 'node-mavlink did not take each datagram as one message')
    for number, message in enumerate(messages):
        check('error' not in message, str(message))
        check(message['bytes'] == message['bytes_of_node_mavlink'], 'other bytes: %s' % message)
        check(message['sequence'] == number % 256, 'sequence: %s' % message)
    return messages


def truth_of(row):
    """Distance and bearing from the bow of each target within reach, the nearest of each sector. The feed's tracks are points."""
    nearest = {}
    for target in row['targets'].values():
        bearing_rad = (target['bearing_rad'] - row['own']['heading_rad']) % (2.0 * math.pi)
        sector = int((math.degrees(bearing_rad) + 2.5) % 360.0 // 5.0)
        if target['range_m'] <= MAX_M and (sector not in nearest or target['range_m'] < nearest[sector][0]):
            nearest[sector] = (target['range_m'], bearing_rad)
    return nearest


def near_border(nearest):
    """Sectors whose target is within a hundredth of a degree of the next one."""
    return any(abs((math.degrees(bearing_rad) + 2.5) % 5.0 - 2.5) > 2.49 for _, bearing_rad in nearest.values())


def check_common(messages, system, component):
    names = {}
    for message in messages:
        check((message['system'], message['component']) == (system, component), str(message))
        names.setdefault(message['name'], []).append(message['fields'])
    check(len(names['HEARTBEAT']) >= SECONDS, '%d heartbeats' % len(names['HEARTBEAT']))
    for fields in names['HEARTBEAT']:
        check((fields['type'], fields['autopilot'], fields['mavlinkVersion']) == (18, 8, 3), str(fields))
    texts = ''.join(fields['text'] for fields in names['STATUSTEXT'])
    check('look-out begins' in texts and 'closest approach 2.5 m in 19 s' in texts, texts)
    return names


def check_sectors(messages, truth):
    looks = check_common(messages, 1, 196)['OBSTACLE_DISTANCE']
    check(len(looks) >= 10 * (SECONDS - 2), '%d looks' % len(looks))
    num_checked = 0
    for fields in looks:
        check((fields['increment'], fields['incrementF'], fields['angleOffset'], fields['frame'], fields['sensorType']) == (5, 5, 0, 12, 0), str(fields))
        check((fields['minDistance'], fields['maxDistance']) == (1, 100 * MAX_M), str(fields))
        nearest = truth_of(truth[fields['timeUsec']])
        if near_border(nearest):
            continue
        num_checked += 1
        check(100 * MAX_M + 1 in fields['distances'], 'nothing is clear')
        for sector, distance_cm in enumerate(fields['distances']):
            # Beams meet nothing: all is clear but for the tracks, and unknown where the beams do not reach.
            if sector in nearest:
                error_m = nearest[sector][0] - distance_cm / 100.0
                check(-0.0005 <= error_m <= MOST_M, 'sector %d: %d cm, true %r' % (sector, distance_cm, nearest[sector]))
            else:
                check(distance_cm in (100 * MAX_M + 1, UNKNOWN), 'sector %d: %d cm where nothing is' % (sector, distance_cm))
    return num_checked


def check_points(messages, truth):
    points = check_common(messages, 255, 1)['OBSTACLE_DISTANCE_3D']
    looks = {}
    for fields in points:
        check((fields['frame'], fields['obstacleId'], fields['maxDistance'], fields['z']) == (12, 65535, MAX_M, 0), str(fields))
        looks.setdefault(fields['timeBootMs'], []).append((fields['x'], fields['y']))
    check(len(looks) >= 10 * (SECONDS - 2), '%d looks' % len(looks))
    by_stamp = {utime_us // 1000 % 2 ** 32: row for utime_us, row in truth.items()}
    for stamp, places in looks.items():
        distances_m = [math.hypot(*place) for place in places]
        check(distances_m == sorted(distances_m), 'not the nearest first: %s' % places)
        nearest = truth_of(by_stamp[stamp])
        if near_border(nearest):
            continue
        true_places = sorted(nearest.values())
        check(len(places) == len(true_places), '%s, true %s' % (places, true_places))
        for (x_m, y_m), (range_m, bearing_rad) in zip(places, true_places):
            error_m = math.hypot(x_m - range_m * math.cos(bearing_rad), y_m - range_m * math.sin(bearing_rad))
            check(error_m < 0.005, '%s, true %s' % (places, true_places))
    return len(looks)


def run():
    with Trial(CONFIG) as trial:
        receivers = [Receiver(port) for port in (20021, 20022)]
        plotter = trial.start_plotter()
        trial.run_feed(SECONDS, PLACE)
        time.sleep(1.5)
        trial.end_plotter(plotter)
        for receiver in receivers:
            receiver.close()
        truth = trial.truth()
        sectors, points = ([datagram for _, datagram in receiver.datagrams] for receiver in receivers)
        print('%d looks in sectors, %d in points: true, and with the bytes of node-mavlink'
              % (check_sectors(decode(trial, sectors), truth), check_points(decode(trial, points), truth)))


if __name__ == '__main__':
    main(run)
