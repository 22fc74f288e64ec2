#!/usr/bin/env python3
"""Clouds as LAS, read by another's reader: each point is the return that our tables have, also on the earth.
  las_test.py SOURCE_FOLDER BUILD_FOLDER NPM_FOLDER"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np
import pandas

import logs

source, build, npm = (pathlib.Path(argument) for argument in sys.argv[1:4])
config = source / 'config/demo'
work = pathlib.Path(tempfile.mkdtemp(prefix='lookout_las_'))
GPS_EPOCH_S, LEAPS_S, ADJUSTED_S = 315964800, 18, 1e9


def run(program, *arguments):
    return logs.run(build / 'bin', program, *arguments)


def table(log, name):
    run('export', '--in', log, '--table', name, '--out', work / 'table.csv', '--force')
    return pandas.read_csv(work / 'table.csv')


def cloud(log, *options):
    run('export', '--in', log, '--table', 'returns', '--format', 'las', '--out', work / 'cloud.las', '--force', *options)
    read = subprocess.run(['node', npm / 'read_las.cjs', work / 'cloud.las'], stdout=subprocess.PIPE, check=True, text=True)
    said = json.loads(read.stdout)
    points = {name: np.array(values) for name, values in said['points'].items()}
    for i, axis in enumerate('XYZ'):
        assert abs(points[axis].min() - said['header']['min'][i]) < 1e-9 and abs(points[axis].max() - said['header']['max'][i]) < 1e-9
    return said['header'], said['wkt'], points


def main():
    run('sim', '--config', config, '--scene', 'crossing', '--seed', '2', '--seconds', '4', '--pcap', work / 'sim.pcap')
    log = work / 'day.lcmlog'
    run('replay', '--config', config, '--in', work / 'sim.pcap', '--out', log)
    shutil.copy(source / 'tests/formats/read_las.cjs', npm)
    returns = table(log, 'returns')

    header, wkt, points = cloud(log, '--scan', 'all')
    assert (header['minorVersion'], header['pointDataRecordFormat'], header['pointCount']) == (4, 6, len(returns)) and wkt.startswith('LOCAL_CS["lidar')
    for axis in 'XYZ':
        assert np.abs(points[axis] - returns[f'{axis.lower()}_m']).max() < 1.1e-4
    assert (points['Intensity'] == 257 * returns.reflectivity).all() and (points['UserData'] == returns.ring).all()
    assert (points['PointSourceId'] == returns.label.fillna(0)).all() and (points['Classification'] == returns.label.notna()).all()
    time_s = points['GpsTime'] + ADJUSTED_S + GPS_EPOCH_S - LEAPS_S
    assert np.abs(time_s - returns.utime_us * 1e-6).max() < 2e-6

    # An obstacle of one return lies where its return lies.
    _, wkt, points = cloud(log, '--scan', 'all', '--frame', 'earth')
    assert wkt.startswith('GEOGCS["WGS 84"')
    time_us = (points['GpsTime'] + ADJUSTED_S + GPS_EPOCH_S - LEAPS_S) * 1e6
    obstacles = table(log, 'obstacles')
    single = obstacles[obstacles.outline_wkt.fillna('').str.startswith('POINT')]
    num_compared = 0
    for _, row in single.iterrows():
        is_of_it = (points['PointSourceId'] == row.obstacle_id) & (time_us > row.scan_utime_us - 10) & (time_us < row.scan_utime_us + 99_000)
        if is_of_it.sum() != 1:
            continue
        longitude_deg, latitude_deg = (float(word) for word in row.outline_wkt[len('POINT('):-1].split())
        metres = np.array([(points['X'][is_of_it][0] - longitude_deg) * np.cos(np.radians(latitude_deg)), points['Y'][is_of_it][0] - latitude_deg]) * 111_200
        assert np.hypot(*metres) < 0.01, (row.scan_utime_us, row.obstacle_id, metres)
        num_compared += 1
    assert num_compared > 100
    print(f'{len(returns)} returns as the table says; {num_compared} obstacles of one return lie on the earth where it lies')
    shutil.rmtree(work)


main()
