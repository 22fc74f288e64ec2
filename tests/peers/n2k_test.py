"""NMEA 2000 of lookout-plotter, as text of two makers' gateways, decoded by canboatjs: the truth, and the bytes that canboatjs would send itself. And as a
device of a network on which canboatjs's own device has the address that ours wants."""
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


DEVICE_PORT, DEVICE_SECONDS = 20013, 12
DEVICE_CONFIG = 'output { name: "device" format: N2K_DEVICE tcp_client { address: "127.0.0.1" port: %d } n2k { unique_number: 74565 } }' % DEVICE_PORT
REQUEST, ACKNOWLEDGEMENT, CLAIM, LIST, HEARTBEAT, PRODUCT = 59904, 59392, 60928, 126464, 126993, 126996
THEIRS, OURS = 35, 36


def ask(gateway, pgn, destination=OURS):
    gateway.stdin.write(json.dumps({'pgn': REQUEST, 'dst': destination, 'prio': 6, 'fields': {'pgn': pgn}}) + '\n')
    gateway.stdin.flush()


def check_claims(ours):
    claims = [note for note in ours if note['pgn'] == CLAIM]
    check([note['src'] for note in claims[:2]] == [THEIRS, OURS], 'claims: %s' % claims)
    fields = claims[0]['fields']
    wanted = {'uniqueNumber': 74565, 'manufacturerCode': 2046, 'deviceFunction': 190, 'deviceClass': 'Navigation', 'industryGroup': 'Marine Industry',
              'arbitraryAddressCapable': 'Yes'}
    check(all(fields[name] == value for name, value in wanted.items()), str(fields))
    # Until nobody has contended for 250 ms nothing else goes out, and the first request comes from nowhere.
    check((ours[0]['pgn'], ours[0]['src']) == (REQUEST, 254), str(ours[0]))
    first = next(note for note in ours if note['pgn'] not in (REQUEST, CLAIM))
    check(first['src'] == OURS and first['time_s'] - claims[1]['time_s'] > 0.24, 'too early: %s' % first)
    check(all(note['src'] == OURS for note in ours if note['time_s'] > claims[1]['time_s']), 'from an address that is not ours')
    check(any(note['pgn'] == CLAIM and note['time_s'] > first['time_s'] for note in ours), 'who asks for addresses is not answered')


def check_answers(ours):
    product = [note['fields'] for note in ours if note['pgn'] == PRODUCT]
    check(len(product) == 1, '%d times product information' % len(product))
    check(product[0]['modelId'] == 'Lookout lidar look-out' and product[0]['modelSerialCode'] == '74565' and product[0]['nmea2000Version'] == 2.1 and
          product[0]['loadEquivalency'] == 0 and product[0]['certificationLevel'] is None, str(product[0]))
    # canboatjs reads on behind the end of a list.
    lists = {note['fields']['functionCode']: [one['pgn'] for one in note['fields']['list'] if one['pgn']] for note in ours if note['pgn'] == LIST}
    check(sorted(len(pgns) for pgns in lists.values()) == [3, 9], str(lists))
    check({POSITION, COURSE, TARGET, HEARTBEAT, PRODUCT} <= set(max(lists.values(), key=len)), str(lists))
    check([note['dst'] for note in ours if note['pgn'] == LIST] == [THEIRS, THEIRS], 'to whom the lists go')
    refusals = [note for note in ours if note['pgn'] == ACKNOWLEDGEMENT]
    check(len(refusals) == 1 and refusals[0]['fields']['pgn'] == 127488 and refusals[0]['fields']['control'] == 'NAK' and refusals[0]['dst'] == THEIRS,
          str(refusals))
    heartbeats = [note['fields'] for note in ours if note['pgn'] == HEARTBEAT]
    check(heartbeats and seconds_of(heartbeats[0]['dataTransmitOffset']) == 60 and heartbeats[0]['equipmentStatus'] == 'Operational', str(heartbeats))


def run_device():
    with Trial(DEVICE_CONFIG) as trial:
        npm = os.path.join(trial.build, 'peers/npm')
        script = os.path.join(trial.source, 'tests/peers/n2k_gateway.cjs')
        gateway = trial.start('gateway', ['node', script, npm, str(DEVICE_PORT)], pipe=True)
        time.sleep(2.5)  # its device has claimed 35
        plotter = trial.start_plotter()
        feed = trial.start_feed(DEVICE_SECONDS, PLACES[0][0])
        time.sleep(4.0)
        for pgn, destination in ((PRODUCT, OURS), (LIST, OURS), (127488, OURS), (127488, 255), (CLAIM, 255)):
            ask(gateway, pgn, destination)
        check(feed.wait(DEVICE_SECONDS + 30) == 0, 'plotter_feed: exit code %s' % feed.returncode)
        trial.end_plotter(plotter)
        check(gateway.poll() is None, 'the gateway ended')
        notes = [json.loads(line) for line in trial.output('gateway').splitlines()]
        check(not [note for note in notes if 'error' in note], 'canboatjs: %s' % [note for note in notes if 'error' in note][:3])
        ours = [note for note in notes if note.get('from') == 'ours']
        check_claims(ours)
        check_answers(ours)
        targets = [note for note in ours if note['pgn'] == TARGET]
        check(len(targets) >= 10 and all(note['src'] == OURS for note in targets), '%d targets' % len(targets))
        told = max(note['time_s'] for note in ours if note['pgn'] == CLAIM and note['src'] == OURS and note['time_s'] <= targets[0]['time_s'])
        print('device: at %d, as canboatjs has %d; %d messages, the first target %.2f s after the claim' % (OURS, THEIRS, len(ours), targets[0]['time_s'] - told))


def run():
    run_device()
    for place, seconds in PLACES:
        run_at(place, seconds)


if __name__ == '__main__':
    main(run)
