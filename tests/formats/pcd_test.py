#!/usr/bin/env python3
"""Clouds as PCD, read and written by PCL's own programs: each point is the return that our tables have, and what PCL has packed comes in again.
  pcd_test.py SOURCE_FOLDER BUILD_FOLDER NPM_FOLDER"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np
import pandas

import logs

source, build = (pathlib.Path(argument) for argument in sys.argv[1:3])
config = source / 'config/demo'
work = pathlib.Path(tempfile.mkdtemp(prefix='lookout_pcd_'))
ASCII, PACKED = '0', '2'


def run(program, *arguments):
    return logs.run(build / 'bin', program, *arguments)


def returns_of(log):
    run('export', '--in', log, '--table', 'returns', '--out', work / 'returns.csv', '--force')
    return pandas.read_csv(work / 'returns.csv')


def export_cloud(log, *options):
    run('export', '--in', log, '--table', 'returns', '--format', 'pcd', '--out', work / 'cloud.pcd', '--force', *options)


def convert(to, kind):
    subprocess.run(['pcl_convert_pcd_ascii_binary', work / 'cloud.pcd', to, kind], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)


def main():
    run('sim', '--config', config, '--scene', 'lake', '--seed', '2', '--seconds', '4', '--pcap', work / 'sim.pcap')
    log = work / 'day.lcmlog'
    run('replay', '--config', config, '--in', work / 'sim.pcap', '--out', log)
    returns = returns_of(log)

    export_cloud(log, '--scan', 'all')
    convert(work / 'ascii.pcd', ASCII)
    lines = (work / 'ascii.pcd').read_text().splitlines()
    begin = lines.index('DATA ascii') + 1
    points = pandas.DataFrame([[float(word) for word in line.split()] for line in lines[begin:]], columns=lines[2].split()[1:])
    assert len(points) == len(returns) > 1000
    for axis in 'xyz':
        assert np.abs(points[axis] - returns[f'{axis}_m']).max() < 1.1e-4
    assert (points.intensity == returns.reflectivity).all() and (points.ring == returns.ring).all() and (points.label == returns.label.fillna(0)).all()
    first_us = returns.scan_utime_us.min()
    assert np.abs(points.time - (returns.utime_us - first_us) * 1e-6).max() < 2e-6

    # One scan, packed by PCL, comes in as the same returns. A ring is known from 20 points on.
    scans = sorted(returns.scan_utime_us.unique())
    one = returns[returns.scan_utime_us == scans[20]].groupby('ring').filter(lambda ring: len(ring) >= 20)
    assert one.ring.nunique() >= 14
    export_cloud(log, '--scan', '20')
    (work / 'packed').mkdir()
    convert(work / f'packed/{scans[20]}.pcd', PACKED)
    assert b'DATA binary_compressed' in (work / f'packed/{scans[20]}.pcd').read_bytes()
    run('import', '--config', config, '--in', work / 'packed', '--out', work / 'packed.lcmlog')
    imported = returns_of(work / 'packed.lcmlog')
    assert len(imported) == len(one), (len(imported), len(one))
    order = ['ring', 'utime_us', 'return_index']
    a, b = one.sort_values(order), imported.sort_values(order)
    assert (a.ring.values == b.ring.values).all() and (a.reflectivity.values == b.reflectivity.values).all()
    for axis in 'xyz':
        assert np.abs(a[f'{axis}_m'].values - b[f'{axis}_m'].values).max() < 0.01, axis
    print(f'{len(returns)} returns as the table says, read by PCL; {len(imported)} of a scan that PCL packed')
    shutil.rmtree(work)


main()
