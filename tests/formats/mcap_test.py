#!/usr/bin/env python3
"""A log as MCAP: read by the libraries of MCAP, by its index and as a stream; Foxglove's messages say what our tables say; imported again it is the same
log; cut off it is read as far as it goes.
  mcap_test.py SOURCE_FOLDER BUILD_FOLDER NPM_FOLDER"""
import base64
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
work = pathlib.Path(tempfile.mkdtemp(prefix='lookout_mcap_'))


def run(program, *arguments, code=0):
    return logs.run(build / 'bin', program, *arguments, code=code)


def table(log, name):
    run('export', '--in', log, '--table', name, '--out', work / 'table.csv', '--force')
    return pandas.read_csv(work / 'table.csv')


def seconds(stamp):
    return stamp['seconds'] * 1000000 + stamp['nanos'] // 1000


def main():
    run('sim', '--config', config, '--scene', 'lake', '--seed', '2', '--seconds', '4', '--pcap', work / 'sim.pcap')
    log, file = work / 'day.lcmlog', work / 'day.mcap'
    run('replay', '--config', config, '--in', work / 'sim.pcap', '--out', log)
    run('export', '--in', log, '--format', 'mcap', '--out', file)
    run('export', '--in', log, '--format', 'mcap', '--out', work / 'again.mcap')
    assert file.read_bytes() == (work / 'again.mcap').read_bytes()

    shutil.copy(source / 'tests/formats/read_mcap.mjs', npm)
    read = json.loads(subprocess.run(['node', str(npm / 'read_mcap.mjs'), str(file)], stdout=subprocess.PIPE, check=True, text=True).stdout)
    counts, messages = read['counts'], read['messages']
    ours = {}
    for channel, _ in logs.events(log):
        ours[channel] = ours.get(channel, 0) + 1
    assert {name: count for name, count in counts.items() if name in ours} == ours
    assert counts['attachment boat.txtpb'] > 0
    assert {'.foxglove.PointCloud', '.foxglove.SceneUpdate', '.foxglove.LocationFix', '.foxglove.FrameTransforms', '.foxglove.GeoJSON'} <= set(read['compared'])

    returns = table(log, 'returns')
    layout = np.dtype({'names': ['x', 'y', 'z', 'reflectivity', 'ring'], 'formats': ['<f4', '<f4', '<f4', 'u1', 'u1'], 'offsets': [0, 4, 8, 12, 13],
                       'itemsize': 14})
    clouds = [np.frombuffer(base64.b64decode(cloud['data']), layout) for cloud in messages['/lidar/points']]
    points = np.concatenate(clouds)
    assert len(points) == len(returns) and len(clouds) == returns.scan_utime_us.nunique()
    for axis in 'xyz':
        assert np.abs(points[axis] - returns[f'{axis}_m']).max() < 6e-5  # the table has four digits
    assert (points['ring'] == returns.ring).all() and (points['reflectivity'] == returns.reflectivity).all()
    assert [seconds(cloud['timestamp']) for cloud in messages['/lidar/points']] == sorted(returns.scan_utime_us.unique())

    pose = table(log, 'pose').set_index('utime_us')
    for fix in messages['/location']:
        row = pose.loc[seconds(fix['timestamp'])]
        assert abs(fix['latitude'] - row.latitude_deg) < 1e-9 and abs(fix['longitude'] - row.longitude_deg) < 1e-9
        assert abs(fix['position_covariance'][0] - row.cov_ee_m2) < 1e-6
    for motion in messages['/motion']:
        row = pose.loc[seconds(motion['timestamp'])]
        assert abs(motion['speed_mps'] - row.speed_mps) < 1e-3 and abs(motion['heading_deg'] - row.heading_deg) < 1e-3
    assert len(messages['/motion']) >= len(messages['/location']) > 0
    transforms = [t for message in messages['/tf'] for t in message['transforms']]
    assert {(t['parent_frame_id'], t['child_frame_id']) for t in transforms} == {('map', 'vessel'), ('vessel', 'lidar')}
    for t in transforms:
        if t['child_frame_id'] == 'vessel':
            heading_rad = np.radians(pose.loc[seconds(t['timestamp'])].heading_deg)
            q = t['rotation']
            forward = np.array([1 - 2 * (q['y']**2 + q['z']**2), 2 * (q['x'] * q['y'] + q['z'] * q['w'])])
            assert np.allclose(forward / np.hypot(*forward), [np.sin(heading_rad), np.cos(heading_rad)], atol=1e-5)

    obstacles = table(log, 'obstacles')
    entities = [entity for scene in messages['/obstacles'] for entity in scene['entities']]
    assert len(entities) == len(obstacles)
    ranges = [float(next(pair['value'] for pair in entity['metadata'] if pair['key'] == 'range_m')) for entity in entities]
    assert np.abs(np.array(ranges) - obstacles.range_m).max() < 1e-3
    tracks = table(log, 'tracks')
    shown = tracks[tracks.status.isin(['confirmed', 'coasting'])]
    entities = [entity for scene in messages['/tracks'] for entity in scene['entities']]
    assert [entity['id'] for entity in entities] == [f'track {number}' for number in shown.track_id]
    for entity, (_, row) in zip(entities, shown.iterrows()):
        assert entity['texts'][0]['text'] == f'{row.kind} {row.track_id}'
    places = [json.loads(message['geojson']) for message in messages['/tracks/map']]
    coordinates = [feature['geometry']['coordinates'] for place in places for feature in place['features']]
    assert np.allclose(np.array(coordinates).reshape(-1, 2), shown[['longitude_deg', 'latitude_deg']], atol=1e-8)
    print(f'{len(points)} points, {len(pose)} poses, {len(obstacles)} obstacles, {len(shown)} states of tracks: as the tables say')

    run('import', '--config', config, '--in', file, '--out', work / 'back.lcmlog')
    assert (work / 'back.lcmlog').read_bytes() == log.read_bytes()
    whole = file.read_bytes()
    for part in (0.3, 0.7, 0.95):
        (work / 'cut.mcap').write_bytes(whole[:int(part * len(whole))])
        run('import', '--config', config, '--in', work / 'cut.mcap', '--out', work / 'cut.lcmlog', '--force', code=3)
        cut = (work / 'cut.lcmlog').read_bytes()
        assert len(cut) > (part - 0.3) * log.stat().st_size and log.read_bytes().startswith(cut)
    print('imported again: the same log; cut off: its beginning')
    shutil.rmtree(work)


main()
