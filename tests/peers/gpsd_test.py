"""gpsd takes the own ship from lookout-plotter's TCP server, and says where it is."""
import calendar
import json
import math
import os
import re
import socket
import time

from plotter import Trial, angle_between, check, distance_m, main

PLACE = (-33.912345, 151.234567)
SECONDS = 8
PORT = 20300
CONFIG = '''
own_ship_period_s: 0.5
output { name: "daemon" format: NMEA0183 tcp_server { bind_address: "127.0.0.1" port: 20301 } alerts: ALF takes_acknowledgements: true }
'''


def reports(connection):
    """What it tells until it is silent for a second."""
    connection.settimeout(1.0)
    text = b''
    try:
        while piece := connection.recv(65536):
            text += piece
    except socket.timeout:
        pass
    return [json.loads(line) for line in text.decode('ascii').splitlines()]


def utime_us_of(text):
    match = re.fullmatch(r'(.*)\.(\d{3})Z', text)
    check(match, 'no time: %s' % text)
    return (calendar.timegm(time.strptime(match[1], '%Y-%m-%dT%H:%M:%S')) * 1000 + int(match[2])) * 1000


def run():
    with Trial(CONFIG) as trial:
        plotter = trial.start_plotter()
        feed = trial.start_feed(SECONDS, PLACE)
        gpsd = os.environ['LOOKOUT_GPSD']
        trial.start('gpsd', [gpsd, '-N', '-n', '-S', str(PORT), 'tcp://127.0.0.1:20301'])
        deadline = time.monotonic() + 10.0
        while True:
            try:
                connection = socket.create_connection(('127.0.0.1', PORT), 1.0)
                break
            except OSError as error:
                check(time.monotonic() < deadline, 'gpsd does not listen: %s' % error)
                time.sleep(0.1)
        connection.sendall(b'?WATCH={"enable":true,"json":true};\n')
        check(feed.wait(SECONDS + 30) == 0, 'plotter_feed: exit code %s' % feed.returncode)
        told = reports(connection)
        trial.end_plotter(plotter)
        truth = trial.truth()
        positions = [report for report in told if report['class'] == 'TPV' and 'lat' in report]
        headings = [report['heading'] for report in told if report['class'] == 'ATT']
        check(len(positions) >= SECONDS and len(headings) >= SECONDS, '%d positions, %d headings' % (len(positions), len(headings)))
        error_m = 0.0
        for position in positions:
            row = truth.get(utime_us_of(position['time']))
            check(row is not None, 'a time at which no POSE was: %s' % position)
            own = row['own']
            error_m = max(error_m, distance_m((position['lat'], position['lon']), (own['latitude_deg'], own['longitude_deg'])))
            check(error_m < 0.01, '%.4f m from the truth: %s' % (error_m, position))
            # RMC has knots and degrees with two decimals.
            check(abs(position['speed'] - own['speed_mps']) < 0.004, 'speed %.3f: %s' % (own['speed_mps'], position))
            check(angle_between(position['track'], math.degrees(own['course_rad'])) < 0.006, 'course: %s' % position)
        all_deg = [math.degrees(row['own']['heading_rad']) for row in truth.values()]
        for heading in headings:
            check(min(angle_between(heading, one) for one in all_deg) < 0.06, 'heading %.3f' % heading)  # POSE every 20 ms, of a boat that turns
        print('gpsd: %d positions at most %.4f m from the truth, %d headings' % (len(positions), error_m, len(headings)))


if __name__ == '__main__':
    main(run)
