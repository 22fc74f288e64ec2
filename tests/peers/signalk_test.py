"""Deltas of lookout-plotter in signalk-server: by each way in, as REST and WebSocket show them; an alert, and its acknowledgement on the way back."""
import base64
import calendar
import hashlib
import hmac
import json
import os
import re
import time
import urllib.error
import urllib.request

from plotter import Trial, check, distance_m, main

PLACE = (54.123456, -10.654321)
SECONDS = 14
SERVER = 'http://127.0.0.1:3000'
TARGETS = {1, 2, 17, 18, 19, 20, 123456}
ALERT_S = 2.0  # when the feed raises it
MOST_LATE_S = 2.0
MOST_M = 0.01
CLOCKS_S = 0.1  # the feed keeps to the clock that nobody sets, and the truth to the host's
KEY = 'a key of this trial alone ' * 4

# name: the output, whether the server wants a token, whether acknowledgements come back this way
WAYS = {
    'udp': ('udp { address: "127.0.0.1" port: 20220 }', False, False),
    'tcp server': ('tcp_server { bind_address: "127.0.0.1" port: 20221 }', True, False),
    'tcp client': ('tcp_client { address: "127.0.0.1" port: 8375 } takes_acknowledgements: true', False, True),
    'websocket': ('websocket { address: "127.0.0.1" port: 3000 token_file: "token" } takes_acknowledgements: true', True, True),
}


def token_of(payload):
    """A JSON Web Token, as the server's own signalk-generate-token makes it."""
    def encode(data):
        return base64.urlsafe_b64encode(data).rstrip(b'=')
    head = encode(json.dumps({'alg': 'HS256', 'typ': 'JWT'}).encode()) + b'.' + encode(json.dumps(payload).encode())
    return (head + b'.' + encode(hmac.new(KEY.encode(), head, hashlib.sha256).digest())).decode()


def write_json(file, value):
    with open(file, 'w', encoding='utf-8') as out:
        json.dump(value, out)
    os.chmod(file, 0o600)


def configure(trial, is_secured, prune_minutes=1):
    """The server, with ways in besides its own and nothing that looks for others or for the network; and the token for lookout-plotter."""
    def way_in(name, kind, options):
        return {'id': name, 'enabled': True, 'pipeElements': [
            {'type': 'providers/simple', 'options': {'logging': False, 'type': kind, 'subOptions': options}}]}
    with open(os.path.join(trial.config, 'token'), 'w', encoding='utf-8') as file:
        file.write(token_of({'device': 'lookout'}) + '\n')
    os.chmod(os.path.join(trial.config, 'token'), 0o600)
    folder = os.path.join(trial.folder, 'server')
    os.mkdir(folder)
    off = ('plugins', 'wasm', 'appstore', 'webapps', 'playground', 'mfd_webapp', 'nmea-tcp', 'logfiles')
    settings = {'interfaces': {name: False for name in off}, 'port': 3000, 'ssl': False, 'mdns': False, 'wsCompression': False,
                'accessLogging': False, 'pruneContextsMinutes': prune_minutes,
                'pipedProviders': [way_in('udp', 'SignalK', {'type': 'udp', 'port': '20220'}),
                                   way_in('tcp', 'SignalK', {'type': 'tcp', 'host': '127.0.0.1', 'port': '20221'}),
                                   way_in('sentences', 'NMEA0183', {'type': 'udp', 'port': '20222'}),
                                   way_in('yden', 'NMEA2000', {'type': 'ydwg02-udp-canboatjs', 'port': '20223'})]}
    if is_secured:
        settings['security'] = {'strategy': './tokensecurity'}
    write_json(os.path.join(folder, 'settings.json'), settings)
    write_json(os.path.join(folder, 'security.json'), {
        'users': [{'username': 'skipper', 'type': 'admin', 'password': ''}],
        'devices': [{'clientId': 'lookout', 'permissions': 'readwrite', 'description': 'lookout', 'config': ''}],
        'secretKey': KEY, 'allow_readonly': False, 'expiration': 'NEVER', 'allowDeviceAccessRequests': False, 'allowNewUserRegistration': False,
        'acls': []})
    write_json(os.path.join(folder, 'baseDeltas.json'), [{'context': 'vessels.self', 'updates': [{'values': [
        {'path': '', 'value': {'name': 'trial', 'uuid': 'urn:mrn:signalk:uuid:c0d79334-4e25-4245-8892-54e8ccc8021d'}}]}]}])


def ask(path, method='GET', body=None):
    """@return what it answers; None where there is nothing"""
    headers = {'Authorization': 'Bearer ' + token_of({'id': 'skipper'}), 'Content-Type': 'application/json'}
    data = None if body is None else json.dumps(body).encode()
    request = urllib.request.Request(SERVER + path, data=data, method=method, headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=5) as answer:
            return json.loads(answer.read())
    except urllib.error.HTTPError as error:
        check(error.code == 404, '%s: %s' % (path, error))
        return None
    except (urllib.error.URLError, ConnectionError):
        return None


def wait_until(is_so, seconds, what):
    deadline = time.monotonic() + seconds
    while not is_so():
        check(time.monotonic() < deadline, 'not within %d s: %s' % (seconds, what))
        time.sleep(0.1)


def start_server(trial):
    folder = os.path.join(trial.folder, 'server')
    environment = dict(os.environ, SIGNALK_NODE_CONFIG_DIR=folder, HOME=folder, NODE_NO_WARNINGS='1')
    program = os.path.join(trial.build, 'peers/npm/node_modules/signalk-server/bin/signalk-server')
    server = trial.start('server', ['node', program], env=environment)
    wait_until(lambda: ask('/signalk') is not None or server.poll() is not None, 60, 'signalk-server answers')
    check(server.poll() is None, 'signalk-server ended')
    return server


def utime_us_of(text):
    match = re.fullmatch(r'(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d)\.(\d{3})Z', text)
    check(match, 'no time of Signal K: %s' % text)
    return (calendar.timegm(time.strptime(match[1], '%Y-%m-%dT%H:%M:%S')) * 1000 + int(match[2])) * 1000


def id_of(name):
    """Of the track, by which a target is called where nobody gave it another name."""
    return int(name.rsplit(' ', 1)[1])


class Seen:
    """When each target was there first and gone first, and notifications; by REST or by WebSocket. Times of the host, s."""

    def __init__(self, way):
        self.way = way
        self.came, self.went = {}, {}
        self.positions = []  # (id or None of the own ship, time of the delta, latitude and longitude)
        self.notifications = []  # (time, value)

    def take_position(self, target_id, time_s, utc, value):
        if value is None:
            if target_id is not None:
                self.went.setdefault(target_id, time_s)
            return
        self.positions.append((target_id, utime_us_of(utc), (value['latitude'], value['longitude'])))
        if target_id is not None:
            check(target_id not in self.went, '%s: target %d is there again' % (self.way, target_id))
            self.came.setdefault(target_id, time_s)

    def check(self, truth):
        """@return the latest that one came, s, and the largest error of a position, m"""
        rows = sorted(truth.items())
        check(set(self.came) == TARGETS, '%s: targets %s' % (self.way, sorted(self.came)))
        latest_s = 0.0
        for target_id, time_s in self.came.items():
            first_us = min(utime_us for utime_us, row in rows if str(target_id) in row['targets'])
            latest_s = max(latest_s, time_s - first_us * 1e-6)
            after_s = time_s - first_us * 1e-6
            check(-CLOCKS_S < after_s < MOST_LATE_S, '%s: target %d came after %.2f s' % (self.way, target_id, after_s))
        check(set(self.went) == TARGETS, '%s: gone are %s' % (self.way, sorted(self.went)))
        for target_id, time_s in self.went.items():
            last_us = max(utime_us for utime_us, row in rows if str(target_id) in row['targets'])
            # Those of the end: after a second of silence.
            after_s = time_s - last_us * 1e-6
            check(-CLOCKS_S < after_s < MOST_LATE_S, '%s: target %d went after %.2f s' % (self.way, target_id, after_s))
        largest_m = 0.0
        for target_id, utime_us, place in self.positions:
            check(utime_us in truth, '%s: a time at which no POSE was: %d' % (self.way, utime_us))
            there = truth[utime_us]['own'] if target_id is None else truth[utime_us]['targets'].get(str(target_id))
            check(there is not None, '%s: target %s was not there' % (self.way, target_id))
            largest_m = max(largest_m, distance_m(place, (there['latitude_deg'], there['longitude_deg'])))
        check(largest_m < MOST_M, '%s: %.4f m from the truth' % (self.way, largest_m))
        check(sum(target_id is None for target_id, _, _ in self.positions) >= 5, '%s: the own ship is not there' % self.way)
        return latest_s, largest_m


def look(seen):
    """By REST, once."""
    time_s = time.time()
    for context, target in (ask('/signalk/v1/api/targets') or {}).items():
        if 'name' not in target:
            continue  # a server that began anew was told the end of one that it never knew
        position = target['navigation']['position']
        check(context.startswith('lidar:') and '.' not in context, context)
        seen.take_position(id_of(target['name']), time_s, position['timestamp'], position['value'])
    own = ask('/signalk/v1/api/vessels/self/navigation/position')
    if own:
        seen.take_position(None, time_s, own['timestamp'], own['value'])
    for name, one in (ask('/signalk/v2/api/notifications') or {}).items():
        if one['path'].startswith('notifications.lookout.closestApproach'):
            seen.notifications.append((time_s, dict(one['value'], id=name, path=one['path'])))


def read_stream(text):
    """What the WebSocket's client noted."""
    seen = Seen('WebSocket')
    names = {}  # by context
    for line in text.splitlines():
        note = json.loads(line)
        message, time_s = note['message'], note['time_s']
        for update in message.get('updates', []):
            for value in update.get('values', []):
                if value['path'] == '' and 'name' in value['value']:
                    names[message['context']] = value['value']['name']
                if value['path'] == 'navigation.position':
                    target_id = id_of(names[message['context']]) if message['context'].startswith('targets.') else None
                    seen.take_position(target_id, time_s, update['timestamp'], value['value'])
                if value['path'].startswith('notifications.lookout.closestApproach'):
                    seen.notifications.append((time_s, value['value']))
    return seen


def check_notifications(seen, acknowledged_s):
    states = [value['state'] for _, value in seen.notifications]
    check(states and states[0] == 'alarm' and states[-1] == 'normal', '%s: states %s' % (seen.way, states))
    first, last = seen.notifications[0][1], seen.notifications[-1][1]
    check(sorted(first['method']) == ['sound', 'visual'] and last['method'] == [], '%s: %s' % (seen.way, (first, last)))
    check('closest approach 2.5 m in 19 s' in first['message'] and '"Nu*$' in first['message'], '%s: %s' % (seen.way, first))
    check(all('createdAt' in value for _, value in seen.notifications if value['message']), '%s: not when it was raised' % seen.way)
    if acknowledged_s is not None:
        loud = [value for time_s, value in seen.notifications if time_s > acknowledged_s + 1.0 and 'sound' in value['method']]
        check(not loud, '%s: sounds after it was acknowledged: %s' % (seen.way, loud))


def run_way(name):
    destination, is_secured, comes_back = WAYS[name]
    with Trial('output { name: "signalk" format: SIGNALK %s }' % destination) as trial:
        configure(trial, is_secured)
        server = start_server(trial)
        npm = os.path.join(trial.build, 'peers/npm')
        stream = trial.start('stream', ['node', os.path.join(trial.source, 'tests/peers/stream.cjs'), npm,
                                        'ws://127.0.0.1:3000/signalk/v1/stream?subscribe=none', token_of({'id': 'skipper'})])
        plotter = trial.start_plotter()
        time.sleep(6.0 if name == 'tcp server' else 1.0)  # the server looks for ours every few seconds
        feed = trial.start_feed(SECONDS, PLACE)
        rest = Seen('REST')
        silenced_s, acknowledged_s = None, None
        end = time.monotonic() + SECONDS + 5.0
        while time.monotonic() < end:
            look(rest)
            # Somebody makes it quiet, which is no acknowledgement, and acknowledges it later.
            if rest.notifications and silenced_s is None:
                silenced_s = time.time()
                ask('/signalk/v2/api/notifications/%s/silence' % rest.notifications[-1][1]['id'], 'POST')
            if silenced_s is not None and acknowledged_s is None and time.time() > silenced_s + 1.5:
                acknowledged_s = time.time()
                ask('/signalk/v2/api/notifications/%s/acknowledge' % rest.notifications[-1][1]['id'], 'POST')
            time.sleep(0.1)
        check(feed.wait(30) == 0, 'plotter_feed: exit code %s' % feed.returncode)
        check(stream.poll() is None and server.poll() is None, 'the client or the server ended')
        trial.end_plotter(plotter)
        truth = trial.truth()
        by_stream = read_stream(trial.output('stream'))
        figures = [seen.check(truth) for seen in (rest, by_stream)]
        for seen in (rest, by_stream):
            check_notifications(seen, acknowledged_s)
        start_us = min(truth)
        alert_s = rest.notifications[0][0] - start_us * 1e-6 - ALERT_S
        check(-CLOCKS_S < alert_s < MOST_LATE_S, 'the alert came after %.2f s' % alert_s)
        acknowledgements = trial.acknowledgements()
        if comes_back:
            check(len(acknowledgements) == 1, 'ALERT_ACK: %s' % acknowledgements)
            ack = acknowledgements[0]
            check(ack['is_right'] and ack['source'] == 'plotter', str(ack))
            after_s = ack['utime_us'] * 1e-6 - acknowledged_s
            check(-CLOCKS_S < after_s < MOST_LATE_S, 'ALERT_ACK after %.2f s' % after_s)
        else:
            check(not acknowledgements, 'ALERT_ACK: %s' % acknowledgements)
        print('%s: targets come within %.2f s (REST), %.2f s (WebSocket); %.4f m from the truth%s' %
              (name, figures[0][0], figures[1][0], max(figure[1] for figure in figures),
               '; ALERT_ACK after %.2f s' % after_s if comes_back else ''))


def is_shown(target_id):
    targets = ask('/signalk/v1/api/targets') or {}
    return any('name' in target and id_of(target['name']) == target_id and target['navigation']['position']['value'] for target in targets.values())


def run_contexts():
    """Many targets that come and go: the server keeps each context of which it was told for an hour, so few of them are told."""
    seconds, num_brief = 130, 260
    with Trial('output { name: "signalk" format: SIGNALK %s targets_as_vessels: true }' % WAYS['websocket'][0]) as trial:
        configure(trial, True, prune_minutes=60)
        start_server(trial)
        plotter = trial.start_plotter()
        feed = trial.start_feed(seconds, PLACE, num_brief)
        time.sleep(seconds - 10)
        own = ask('/signalk/v1/api/self').split('.', 1)[1]
        targets, vessels = ask('/signalk/v1/api/targets'), ask('/signalk/v1/api/vessels')
        check(own in vessels, 'the own ship is not there: %s' % own)
        del vessels[own]
        names = {kind: sorted(one['name'] for one in contexts.values() if one['navigation']['position']['value'])
                 for kind, contexts in (('targets', targets), ('vessels', vessels))}
        check(len(names['targets']) == len(set(names['targets'])), 'one stands twice: %s' % names['targets'])
        check(all('mmsi' not in vessel for vessel in vessels.values()), 'a vessel has an MMSI')
        # Two a second, of which each stays for 4 s and then for the minute in which its place is free.
        check(len(targets) <= 150 and abs(len(vessels) - len(targets)) <= 2, '%d targets, %d vessels' % (len(targets), len(vessels)))
        check(10 <= len(names['targets']) <= 18 and len(set(names['targets']) ^ set(names['vessels'])) <= 4, str(names))
        check(any(vessel['name'].startswith('lost: ') for vessel in vessels.values()), 'those that are gone bear their names')
        feed.wait(30)
        trial.end_plotter(plotter)
        time.sleep(1.0)
        alive = [one['name'] for kind in ('targets', 'vessels') for context, one in (ask('/signalk/v1/api/' + kind) or {}).items()
                 if context != own and one['navigation']['position']['value']]
        check(not alive, 'there after the end: %s' % alive)
        print('contexts: %d for %d targets, %d of them alive' % (len(targets), num_brief + len(TARGETS), len(names['targets'])))


def run_restart():
    """The server ends and begins anew: it is told all again, and an acknowledgement comes back."""
    with Trial('output { name: "signalk" format: SIGNALK %s }' % WAYS['websocket'][0]) as trial:
        configure(trial, True)
        server = start_server(trial)
        plotter = trial.start_plotter()
        feed = trial.start_feed(30, PLACE)
        wait_until(lambda: is_shown(17), 10, 'target 17')
        server.kill()
        server.wait()
        time.sleep(2.0)
        start_server(trial)
        check(not is_shown(17), 'the server remembers what it should not')
        # Within 5 s it is looked for again, and a moving target is told every 2.5 s.
        wait_until(lambda: is_shown(17), 8, 'target 17 after the restart')
        seen = Seen('REST')

        def is_alert_shown():
            look(seen)
            return bool(seen.notifications)
        wait_until(is_alert_shown, 3, 'the alert after the restart')
        # As displays do that do not know the server's notifications API.
        path = seen.notifications[-1][1]['path'].replace('.', '/')
        ask('/signalk/v1/api/vessels/self/%s/method' % path, 'PUT', {'value': ['visual']})
        wait_until(trial.acknowledgements, 3, 'ALERT_ACK after the restart')
        check(feed.poll() is None, 'plotter_feed ended too early')
        feed.terminate()
        trial.end_plotter(plotter)
        print('restart: targets and the alert are told again, and ALERT_ACK comes')


def run_other_inputs():
    """The own ship, by the server's readers of NMEA 0183 and NMEA 2000."""
    with Trial('''
output { name: "sentences" format: NMEA0183 udp { address: "127.0.0.1" port: 20222 } alerts: ALF }
output { name: "yden" format: N2K_YDEN udp { address: "127.0.0.1" port: 20223 } }''') as trial:
        configure(trial, False)
        start_server(trial)
        plotter = trial.start_plotter()
        feed = trial.start_feed(8, PLACE)
        told = {}  # by source: positions
        while feed.poll() is None:
            position = ask('/signalk/v1/api/vessels/self/navigation/position')
            by_source = {} if position is None else position.get('values') or {position['$source']: position}
            for source, one in by_source.items():
                told.setdefault(source.split('.')[0], []).append((one['value']['latitude'], one['value']['longitude']))
            time.sleep(0.1)
        trial.end_plotter(plotter)
        places = [(row['own']['latitude_deg'], row['own']['longitude_deg']) for row in trial.truth().values()]
        check(set(told) == {'sentences', 'yden'}, 'sources %s' % sorted(told))
        errors_m = {source: max(min(distance_m(one, place) for place in places) for one in set(ones)) for source, ones in told.items()}
        check(max(errors_m.values()) < 0.02, 'from the truth, m: %s' % errors_m)
        print('other inputs: from the truth, m: %s' % {source: round(error_m, 4) for source, error_m in errors_m.items()})


def run():
    for name in WAYS:
        run_way(name)
    run_restart()
    run_contexts()
    run_other_inputs()


if __name__ == '__main__':
    main(run)
