"""What the trials of the plotter share: a folder, a config, the processes, the truth, and a place where datagrams come."""
import json
import math
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time

KNOTS_PER_MPS = 3600.0 / 1852.0
KMH_PER_MPS = 3.6
BOAT = 'Nu, *$^!~ "Mary"'  # what a sentence cannot hold


class Failed(Exception):
    pass


def check(is_so, text):
    if not is_so:
        raise Failed(text)


def angle_between(one_deg, other_deg):
    return abs((one_deg - other_deg + 180.0) % 360.0 - 180.0)


def earth_of(latitude_deg, longitude_deg):
    """Earth-centred, on the ellipsoid of WGS84, m."""
    flattening = 1.0 / 298.257223563
    eccentricity2 = flattening * (2.0 - flattening)
    latitude, longitude = math.radians(latitude_deg), math.radians(longitude_deg)
    normal_m = 6378137.0 / math.sqrt(1.0 - eccentricity2 * math.sin(latitude) ** 2)
    return (normal_m * math.cos(latitude) * math.cos(longitude), normal_m * math.cos(latitude) * math.sin(longitude),
            normal_m * (1.0 - eccentricity2) * math.sin(latitude))


def distance_m(one, other):
    """Between two places (latitude and longitude in degrees), straight."""
    return math.dist(earth_of(*one), earth_of(*other))


def offset_earth(place, east_m, north_m):
    """Earth-centred, on the plane that touches the earth at `place`."""
    latitude, longitude = math.radians(place[0]), math.radians(place[1])
    east = (-math.sin(longitude), math.cos(longitude), 0.0)
    north = (-math.sin(latitude) * math.cos(longitude), -math.sin(latitude) * math.sin(longitude), math.cos(latitude))
    return tuple(here + east_m * along_east + north_m * along_north for here, along_east, along_north in zip(earth_of(*place), east, north))


class Receiver:
    """Datagrams to a port of this computer, with the time at which each came."""

    def __init__(self, port):
        self.port = port
        self.datagrams = []
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        self._socket.bind(('127.0.0.1', port))
        self._socket.settimeout(0.2)
        self._is_closed = False
        self._thread = threading.Thread(target=self._receive, daemon=True)
        self._thread.start()

    def _receive(self):
        while not self._is_closed:
            try:
                datagram = self._socket.recv(65536)
            except socket.timeout:
                continue
            self.datagrams.append((time.time(), datagram))

    def close(self):
        self._is_closed = True
        self._thread.join()
        self._socket.close()

    def lines(self):
        """Each with its time, without its end, which is checked."""
        lines = []
        for time_s, datagram in self.datagrams:
            check(datagram.endswith(b'\r\n'), 'a datagram that does not end a line: %r' % datagram)
            lines += [(time_s, line.decode('ascii')) for line in datagram.split(b'\r\n')[:-1]]
        return lines


class Trial:
    """lookout-plotter and the feed, in a folder of their own. Ends what it started, and nothing else."""

    def __init__(self, config):
        self.source, self.build = sys.argv[1], sys.argv[2]
        self.folder = tempfile.mkdtemp(prefix='lookout_peers.')
        self.config = os.path.join(self.folder, 'config')
        shutil.copytree(os.path.join(self.source, 'config/demo'), self.config)
        boat = os.path.join(self.config, 'boat.txtpb')
        with open(boat, encoding='utf-8') as file:
            text = file.read()
        check('name: "demo"' in text, 'the demo boat has another name')
        with open(boat, 'w', encoding='utf-8') as file:
            file.write(text.replace('name: "demo"', 'name: "%s"' % BOAT.replace('"', '\\"')))
        with open(os.path.join(self.config, 'plotter.txtpb'), 'w', encoding='utf-8') as file:
            file.write(config)
        self.truth_file = os.path.join(self.folder, 'truth')
        self._processes = []

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        for process in reversed(self._processes):
            if process.poll() is None:
                process.terminate()
                try:
                    process.wait(10)
                except subprocess.TimeoutExpired:
                    process.kill()
        if error is None:
            shutil.rmtree(self.folder)
        else:
            for name in sorted(os.listdir(self.folder)):
                if name.endswith('.out'):
                    print('--- %s' % name)
                    print(self.output(name[:-4])[-2000:])

    def start(self, name, command, pipe=False, **options):
        """@param pipe  its standard input is written by the trial, as text"""
        out = open(os.path.join(self.folder, name + '.out'), 'w', encoding='utf-8')
        stdin = subprocess.PIPE if pipe else subprocess.DEVNULL
        process = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, stdin=stdin, text=pipe, **options)
        self._processes.append(process)
        return process

    def output(self, name):
        with open(os.path.join(self.folder, name + '.out'), encoding='utf-8', errors='replace') as file:
            return file.read()

    def start_plotter(self):
        plotter = self.start('plotter', [os.path.join(self.build, 'bin/lookout-plotter'), '--config', self.config])
        time.sleep(1.0)
        check(plotter.poll() is None, 'lookout-plotter ended')
        return plotter

    def start_feed(self, seconds, place, num_brief=0):
        return self.start('feed', [os.path.join(self.build, 'tests/plotter_feed'), str(seconds), self.truth_file, str(place[0]), str(place[1]), str(num_brief)])

    def run_feed(self, seconds, place):
        code = self.start_feed(seconds, place).wait(seconds + 30)
        check(code == 0, 'plotter_feed: exit code %d' % code)

    def end_plotter(self, plotter):
        plotter.terminate()
        check(plotter.wait(10) == 0, 'lookout-plotter: exit code %d' % plotter.returncode)

    def _truth_lines(self):
        with open(self.truth_file, encoding='utf-8') as file:
            return [json.loads(line) for line in file.read().split('\n')[:-1]]

    def truth(self):
        """Where all are, by the time of each POSE in microseconds."""
        return {line['utime_us']: line for line in self._truth_lines() if 'own' in line}

    def acknowledgements(self):
        if not os.path.exists(self.truth_file):
            return []
        return [line for line in self._truth_lines() if 'ack' in line]


def truth_by_time_of_day(truth):
    """By hours, minutes and seconds with three decimals."""
    by_time = {}
    for utime_us, row in truth.items():
        milliseconds = utime_us // 1000
        text = time.strftime('%H%M%S', time.gmtime(milliseconds // 1000)) + '.%03d' % (milliseconds % 1000)
        by_time[text] = row
    return by_time


def main(run):
    """A failed check ends the test with its text."""
    try:
        run()
    except Failed as failed:
        print('FAILED: %s' % failed)
        sys.exit(1)
