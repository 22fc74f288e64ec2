"""NMEA 2000 of lookout-plotter, as text of two makers' gateways, decoded by canboatjs: the truth, and the bytes that canboatjs would send itself."""
import json
import math
import os
import subprocess
import time

from plotter import Receiver, Trial, check, distance_m, main, truth_by_time_of_day

PLACES = [((54.123456, 10.654321), 14), ((-0.0002, -179.9997), 6)]
CONFIG = '''
output { name: "actisense" format: N2K_ACTISENSE udp { address: "127.0.0.1" port: 20011 } }
output { name: "yden" format: N2K_YDEN udp { address: "127.0.0.1" port: 20012 } }
'''
PORTS = (20011, 20012)
TARGETS = {1, 2, 17, 18, 19, 20, 123456}
LOST = 19
POSITION, COURSE, TARGET = 129025, 129026, 128520
# Half of the last digit that a field has, and a little: 1e-7 deg is 11 mm.
MOST_M, MOST_RAD, MOST_MPS = 0.01, 0.0001, 0.01


def radians_between(one, other):
    return abs((one - other + math.pi) % (2.0 * math.pi) - math.pi)


def seconds_of(text):
    """canboatjs tells times as hours, minutes and seconds."""
    hours, minutes, seconds = text.split(':')
    return 3600 * int(hours) + 60 * int(minutes) + float(seconds)


def check_value(name, value, truth, most, message, difference=lambda one, other: abs(one - other)):
    if truth is None:
        check(value is None, '%s is there: %s' % (name, message))
    else:
        check(value is not None and difference(value, truth) <= 0.5 * most + 1e-6, '%s: %r, true %r: %s' % (name, value, truth, message))


def decode(trial, lines):
    npm = os.path.join(trial.build, 'peers/npm')
    script = os.path.join(trial.source, 'tests/peers/decode_n2k.cjs')
    run = subprocess.run(['node', script, npm], input=''.join(line + '\r\n' for line in lines), capture_output=True, text=True, check=True)
    messages = [json.loads(line) for line in run.stdout.splitlines()]
    for message in messages:
        check('error' not in message, 'canboatjs: %s: %s' % (message.get('error'), lines[message['line']]))
    return messages


def row_of(truth, message):
    text = message['time'].replace(':', '')
    check(text in truth, 'a time at which no POSE was: %s' % message)
    return truth[text]


def check_target(row, message, told):
    fields = message['fields']
    check(abs(seconds_of(fields['utcOfFix']) - row['utime_us'] % 86_400_000_000 * 1e-6) < 1e-4, 'UTC: %s' % message)
    for name, wanted in (('reportedTarget', 'No'), ('targetAcquisition', 'Automatic'), ('bearingReference', 'True')):
        check(fields[name] == wanted, '%s: %s' % (name, message))
    check(0 <= fields['targetId'] <= 99, 'number: %s' % message)
    target_id = int(fields['name'].split()[-1])
    statuses = told.setdefault(target_id, [])
    check('Lost' not in statuses, 'told after it was lost: %s' % message)
    statuses.append(fields['trackStatus'])
    target = row['targets'].get(str(target_id))
    if fields['trackStatus'] == 'Lost':
        check(target is None, 'lost, and it is there: %s' % message)
        return
    check(fields['trackStatus'] == 'Tracking' and target is not None, str(message))
    check_value('distance', fields['distance'], target['range_m'], MOST_M, message)
    check_value('bearing', fields['bearing'], target['bearing_rad'], MOST_RAD, message, radians_between)
    check_value('course', fields['course'], target['course_rad'], MOST_RAD, message, radians_between)
    check_value('speed', fields['speed'], target['speed_mps'], MOST_MPS, message)
    check_value('cpa', fields['cpa'], target['cpa_m'], MOST_M, message)
    check_value('tcpa', seconds_of(fields['tcpa']), target['tcpa_s'], 0.001, message)


def check_output(truth, messages, is_long):
    told, counts, errors_m = {}, {}, []
    for message in messages:
        counts[message['pgn']] = counts.get(message['pgn'], 0) + 1
        check(message['pgn'] in (POSITION, COURSE, TARGET), 'a message that nobody asked for: %s' % message)
        row, fields = row_of(truth, message), message['fields']
        if message['pgn'] == POSITION:
            errors_m.append(distance_m((fields['latitude'], fields['longitude']), (row['own']['latitude_deg'], row['own']['longitude_deg'])))
            check(errors_m[-1] <= MOST_M, '%.4f m from the truth: %s' % (errors_m[-1], message))
        elif message['pgn'] == COURSE:
            check(fields['cogReference'] == 'True', str(message))
            check_value('cog', fields['cog'], row['own']['course_rad'], MOST_RAD, message, radians_between)
            check_value('sog', fields['sog'], row['own']['speed_mps'], MOST_MPS, message)
        else:
            check_target(row, message, told)
        # Of a whole message in one line: what canboatjs makes of the decoded values.
        if 'bytes' in message:
            check(message['bytes'] == message['bytes_of_canboat'], 'other bytes: %s' % message)
    check(counts.get(POSITION, 0) >= 5 and counts.get(COURSE, 0) >= 5 and counts.get(TARGET, 0) >= 10, str(counts))
    if is_long:
        check(set(told) == TARGETS, 'targets %s' % sorted(told))
        for target_id, statuses in told.items():
            check(statuses.count('Lost') == (1 if target_id == LOST else 0) and statuses.count('Tracking') >= (2 if target_id == LOST else 4),
                  '%d: %s' % (target_id, statuses))
    return counts, max(errors_m)


def run_at(place, seconds):
    with Trial(CONFIG) as trial:
        receivers = [Receiver(port) for port in PORTS]
        plotter = trial.start_plotter()
        trial.run_feed(seconds, place)
        time.sleep(1.5)
        trial.end_plotter(plotter)
        truth = truth_by_time_of_day(trial.truth())
        for port, receiver in zip(PORTS, receivers):
            receiver.close()
            lines = [line for _, line in receiver.lines()]
            counts, error_m = check_output(truth, decode(trial, lines), seconds > 12)
            print('at %.5f %.5f, port %d: %s; positions at most %.4f m from the truth' % (*place, port, counts, error_m))


def run():
    for place, seconds in PLACES:
        run_at(place, seconds)


if __name__ == '__main__':
    main(run)
