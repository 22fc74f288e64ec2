"""Sentences of lookout-plotter, read by python3-nmea2 and by go-nmea: both read the same, and it is the truth."""
import json
import math
import os
import re
import subprocess
import time

import pynmea2

from plotter import (KMH_PER_MPS, KNOTS_PER_MPS, Failed, Receiver, Trial, angle_between, check, distance_m, earth_of, main, offset_earth,
                     truth_by_time_of_day)

# Also on the equator and the date line, and near a pole. The first is long enough for what comes and goes.
PLACES = [((54.123456, 10.654321), 14), ((-33.9, -70.2), 6), ((0.00031, 179.99962), 6), ((-0.0002, -179.9997), 6), ((79.5, -15.0), 6)]
CONFIG = '''
output { name: "ttm" format: NMEA0183 udp { address: "127.0.0.1" port: 20001 } alerts: ALF }
output { name: "miles" format: NMEA0183 udp { address: "127.0.0.1" port: 20002 } unit: NAUTICAL_MILES alerts: ALR own_ship_talker: "GP" }
output { name: "tll" format: NMEA0183 udp { address: "127.0.0.1" port: 20003 } targets: TLL target_talker: "SN" }
'''
PORTS = (20001, 20002, 20003)
TELLS = re.compile(r'(closest approach|CPA) 2\.5 m')  # in short words where the whole text does not fit
ALERTS = {20001: (True, False), 20002: (False, True), 20003: (False, False)}  # ALF, ALR
TARGETS = {1, 2, 17, 18, 19, 20, 123456}
LOST, LATE, TENTATIVE = 19, 123456, 21
UNITS = {'K': (1000.0, KMH_PER_MPS), 'N': (1852.0, KNOTS_PER_MPS)}
EXTRA = 1e-4  # of each unit, beside half of the last digit that is printed
LEAST_PERIOD_S = 2.3  # of a target: 2.5 s, less what a busy computer may be late with


def check_form(line):
    check(len(line) + 2 <= 82, 'longer than 82: %s' % line)
    check(line[0] == '$' and line[-3] == '*' and line.count('$') == 1 and line.count('*') == 1, 'no sentence: %s' % line)
    check(all(' ' <= letter <= '~' and letter not in '!\\^~' for letter in line), 'reserved characters: %s' % line)
    checksum = 0
    for letter in line[1:-3]:
        checksum ^= ord(letter)
    check('%02X' % checksum == line[-2:], 'checksum: %s' % line)


def read_by_go(build, lines):
    run = subprocess.run([os.path.join(build, 'peers/sentences')], input='\n'.join(lines) + '\n', capture_output=True, text=True, check=True)
    read = [json.loads(line) for line in run.stdout.splitlines()]
    check(len(read) == len(lines), 'go-nmea: %d of %d lines' % (len(read), len(lines)))
    return read


def degrees(angle_rad):
    return None if angle_rad is None else math.degrees(angle_rad)


class Sentence:
    """As both libraries read it."""

    def __init__(self, line, by_go):
        self.line = line
        self.fields = line[1:-3].split(',')[1:]
        try:
            self.by_python = pynmea2.parse(line, check=True)
        except pynmea2.ParseError as error:
            raise Failed('nmea2: %s: %s' % (error, line)) from error
        check('error' not in by_go, 'go-nmea: %s: %s' % (by_go.get('error'), line))
        self.by_go = by_go

    def check_number(self, field, python_name, go_name, truth, is_angle=False):
        """Equal in both, and the truth to half the last digit. A truth of None is an empty field."""
        text = self.fields[field]
        if truth is None:
            check(text == '', '%s is not empty: %s' % (go_name, self.line))
            return
        check(text != '', '%s is empty: %s' % (go_name, self.line))
        python_value, go_value = float(getattr(self.by_python, python_name)), self.by_go[go_name]
        check(python_value == go_value, '%s: %r and %r: %s' % (go_name, python_value, go_value, self.line))
        decimals = len(text.partition('.')[2])
        error = angle_between(go_value, truth) if is_angle else abs(go_value - truth)
        check(error <= 0.5 * 10 ** -decimals + EXTRA, '%s: %r, true %r: %s' % (go_name, go_value, truth, self.line))

    def check_text(self, python_name, go_name, wanted):
        values = getattr(self.by_python, python_name), self.by_go[go_name]
        check(values == (wanted, wanted), '%s: %r, not %r: %s' % (go_name, values, wanted, self.line))

    def check_place(self, go_latitude, go_longitude, truth):
        place = self.by_python.latitude, self.by_python.longitude
        by_go = self.by_go[go_latitude], self.by_go[go_longitude]
        check(max(abs(a - b) for a, b in zip(place, by_go)) < 1e-11, '%r and %r: %s' % (place, by_go, self.line))
        error_m = distance_m(place, (truth['latitude_deg'], truth['longitude_deg']))
        check(error_m < 0.005, '%.4f m from the truth: %s' % (error_m, self.line))
        return place

    def row(self, truth, field):
        """Of its time."""
        time, by_go = self.by_python.timestamp, self.by_go.get('TimeUTC') or self.by_go['Time']
        check((time.hour, time.minute, time.second, time.microsecond) ==
              (by_go['Hour'], by_go['Minute'], by_go['Second'], 1000 * by_go['Millisecond']), 'time: %s' % self.line)
        row = truth.get((self.fields[field] + '00')[:10])
        check(row is not None, 'a time at which no POSE was: %s' % self.line)
        return row


class Output:
    """What came of one, sentence by sentence."""

    def __init__(self, truth):
        self.truth = truth
        self.own_row = None  # of the last RMC
        self.own_place = None
        self.counts = {}
        self.told = {}       # by id: when, and the status
        self.number_of = {}  # by id
        self.alerts = []     # fields
        self.largest_error_m = 0.0

    def take(self, time_s, line, by_go):
        kind = line[3:6]
        self.counts[kind] = self.counts.get(kind, 0) + 1
        takers = {'RMC': self.take_rmc, 'HDT': self.take_hdt, 'OSD': self.take_osd, 'TTM': self.take_ttm, 'TLL': self.take_tll}
        if kind in takers:
            takers[kind](time_s, Sentence(line, by_go))
        else:  # which neither library knows
            fields = line[7:-3].split(',')
            if kind == 'HBT':
                check(fields[0] == '30' and fields[1] in ('A', 'V') and fields[2].isdigit(), 'HBT: %s' % line)
            elif kind == 'ALC':
                entries = [fields[i:i + 4] for i in range(4, len(fields), 4)]
                check(len(entries) == int(fields[3]) and all(entry[0] == 'LKO' and len(entry) == 4 for entry in entries), 'ALC: %s' % line)
            else:
                check(kind in ('ALF', 'ALR'), 'a sentence that nobody asked for: %s' % line)
                self.alerts.append(fields)

    def take_rmc(self, _, sentence):
        self.own_row = sentence.row(self.truth, 0)
        own = self.own_row['own']
        sentence.check_text('status', 'Validity', 'A')
        self.own_place = sentence.check_place('Latitude', 'Longitude', own)
        sentence.check_number(6, 'spd_over_grnd', 'Speed', own['speed_mps'] * KNOTS_PER_MPS)
        sentence.check_number(7, 'true_course', 'Course', degrees(own['course_rad']), True)
        date, by_go = sentence.by_python.datestamp, sentence.by_go['Date']
        check((date.day, date.month, date.year) == (by_go['DD'], by_go['MM'], 2000 + by_go['YY']), 'date: %s' % sentence.line)

    # They have no time: they belong to the RMC before them.
    def take_hdt(self, _, sentence):
        sentence.check_number(0, 'heading', 'Heading', degrees(self.own_row['own']['heading_rad']), True)
        check(sentence.by_python.hdg_true == 'T' and sentence.by_go['True'], sentence.line)

    def take_osd(self, _, sentence):
        own = self.own_row['own']
        sentence.check_number(0, 'heading', 'Heading', degrees(own['heading_rad']), True)
        sentence.check_text('status', 'HeadingStatus', 'A')
        sentence.check_number(2, 'course', 'VesselTrueCourse', degrees(own['course_rad']), True)
        sentence.check_number(4, 'speed', 'VesselSpeed', own['speed_mps'] * UNITS[sentence.by_go['SpeedUnits']][1])
        sentence.check_text('speed_ref', 'SpeedReference', 'P')

    def take_target(self, time_s, sentence, name, status, field):
        row = sentence.row(self.truth, field)
        target_id = int(name.split()[-1])
        check(target_id != TENTATIVE, 'a tentative track: %s' % sentence.line)
        number = sentence.by_go['TargetNumber']
        check(self.number_of.setdefault(target_id, number) == number, 'another number: %s' % sentence.line)
        told = self.told.setdefault(target_id, [])
        check(not told or told[-1][1] != 'L', 'told after it was lost: %s' % sentence.line)
        if status == 'L':
            check(str(target_id) not in row['targets'], 'lost, and it is there: %s' % sentence.line)
        elif told:
            check(time_s - told[-1][0] > LEAST_PERIOD_S, 'told after %.2f s: %s' % (time_s - told[-1][0], sentence.line))
        told.append((time_s, status))
        return row, None if status == 'L' else row['targets'][str(target_id)]

    def take_ttm(self, time_s, sentence):
        row, target = self.take_target(time_s, sentence, sentence.by_go['TargetName'], sentence.by_go['TargetStatus'], 13)
        for names in (('status', 'TargetStatus'), ('name', 'TargetName'), ('brg_ref', 'BearingType'), ('dist_unit', 'SpeedUnits')):
            sentence.check_text(*names, sentence.by_go[names[1]])
        sentence.check_text('acquisition', 'TypeOfAcquisition', 'A')
        sentence.check_text('brg_ref', 'BearingType', 'T')
        if target is None:
            return
        metres, per_mps = UNITS[sentence.by_go['SpeedUnits']]
        sentence.check_number(1, 'distance', 'TargetDistance', target['range_m'] / metres)
        sentence.check_number(2, 'bearing', 'Bearing', degrees(target['bearing_rad']), True)
        sentence.check_number(4, 'speed', 'TargetSpeed', target['speed_mps'] * per_mps)
        sentence.check_number(5, 'cog', 'TargetCourse', degrees(target['course_rad']), True)
        sentence.check_number(7, 'dist_cpa', 'DistanceCPA', target['cpa_m'] / metres)
        sentence.check_number(8, 'time_cpa', 'TimeCPA', target['tcpa_s'] / 60.0)
        self.check_rebuilt(sentence, row, target, metres)

    def check_rebuilt(self, sentence, row, target, metres):
        """As a plotter draws it: beside the position of the last RMC, carried on to the time of TTM."""
        own = self.own_row['own']
        after_s = (row['utime_us'] - self.own_row['utime_us']) * 1e-6
        check(0.0 <= after_s < 0.2, 'TTM %.2f s after RMC: %s' % (after_s, sentence.line))
        range_m, bearing_rad = sentence.by_go['TargetDistance'] * metres, math.radians(sentence.by_go['Bearing'])
        east_m = range_m * math.sin(bearing_rad) + after_s * own['speed_mps'] * math.sin(own['course_rad'])
        north_m = range_m * math.cos(bearing_rad) + after_s * own['speed_mps'] * math.cos(own['course_rad'])
        error_m = math.dist(offset_earth(self.own_place, east_m, north_m), earth_of(target['latitude_deg'], target['longitude_deg']))
        error_at_100_m = error_m / max(1.0, range_m / 100.0)
        self.largest_error_m = max(self.largest_error_m, error_at_100_m)
        check(error_at_100_m < 0.3, '%.2f m from the truth: %s' % (error_m, sentence.line))

    def take_tll(self, time_s, sentence):
        _, target = self.take_target(time_s, sentence, sentence.by_go['TargetName'], sentence.by_go['TargetStatus'], 6)
        sentence.check_text('target_status', 'TargetStatus', sentence.by_go['TargetStatus'])
        if target is not None:
            sentence.check_place('TargetLatitude', 'TargetLongitude', target)

    def check_alerts(self):
        if 'ALR' in self.counts:
            mine = [fields[2:4] for fields in self.alerts if fields[1] == '004' and TELLS.search(fields[4])]
            check(mine and mine[0] == ['A', 'V'] and mine[-1][0] == 'V', 'ALR: %s' % self.alerts)
        if 'ALF' in self.counts:
            titles = [fields for fields in self.alerts if fields[1] == '1' and fields[9] == '4']
            texts = [fields for fields in self.alerts if fields[1] == '2' and TELLS.search(fields[-1])]
            check(titles and len(titles) == len(texts) and {len(fields) for fields in self.alerts} == {13}, 'ALF: %s' % self.alerts)
            check(titles[0][5:7] == ['W', 'V'] and titles[-1][6] == 'N', 'ALF: %s' % titles)

    def check_whole_scene(self, kind):
        check(set(self.told) == TARGETS, 'targets %s' % sorted(self.told))
        check(len(set(self.number_of.values())) == len(TARGETS), 'numbers %s' % self.number_of)
        for target_id, told in self.told.items():
            statuses = ''.join(status for _, status in told)
            check(statuses.count('L') == (1 if target_id == LOST else 0), '%d: %s' % (target_id, statuses))
            check(statuses.count('T') >= (2 if target_id == LOST else 4), '%d: %s' % (target_id, statuses))
        check(self.told[LATE][0][0] - min(told[0][0] for told in self.told.values()) > 2.5, 'told before it was there')
        check(self.counts['RMC'] >= 10 and self.counts['HDT'] >= 10 and self.counts[kind] >= 25, str(self.counts))


def run_at(place, seconds):
    with Trial(CONFIG) as trial:
        receivers = [Receiver(port) for port in PORTS]
        plotter = trial.start_plotter()
        trial.run_feed(seconds, place)
        time.sleep(1.5)
        end_s = time.time()
        trial.end_plotter(plotter)
        truth = truth_by_time_of_day(trial.truth())
        errors, counts = [], []
        for receiver, kind in zip(receivers, ('TTM', 'TTM', 'TLL')):
            lines = [one for one in receiver.lines() if one[0] < end_s]
            check(lines, 'nothing came')
            # Who ends in order leaves no target standing.
            last = [line for time_s, line in receiver.lines() if time_s >= end_s and line[3:6] == kind]
            check(last and all(',L,' in line for line in last), 'told at the end: %s' % last)
            output = Output(truth)
            for (time_s, line), by_go in zip(lines, read_by_go(trial.build, [line for _, line in lines])):
                check_form(line)
                output.take(time_s, line, by_go)
            check(output.counts.get(kind, 0) >= 10, str(output.counts))
            if seconds > 12:
                output.check_whole_scene(kind)
                output.check_alerts()
                check(('ALF' in output.counts, 'ALR' in output.counts) == ALERTS[receiver.port], str(output.counts))
            errors.append(output.largest_error_m)
            counts.append(output.counts)
            receiver.close()
        print('at %.5f %.5f: %s; rebuilt at 100 m: at most %.3f m, in nautical miles %.3f m' % (*place, counts, errors[0], errors[1]))


def run():
    for place, seconds in PLACES:
        run_at(place, seconds)


if __name__ == '__main__':
    main(run)
