#!/usr/bin/env python3
"""The look-out as Foxglove sees it live: Foxglove's own client subscribes every channel of lookout-page while a log is played on the bus; it is sent the
messages of an MCAP file of this log, byte for byte. In a network namespace of its own.
  foxglove_test.py SOURCE_FOLDER BUILD_FOLDER NPM_FOLDER"""
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile

import logs

source, build, npm = (pathlib.Path(argument) for argument in sys.argv[1:4])
work = pathlib.Path(tempfile.mkdtemp(prefix='lookout_foxglove_'))
config = work / 'config'
PORT = 8765


def run(program, *arguments):
    return logs.run(build / 'bin', program, *arguments)


def look(log, file, protocol):
    page = subprocess.Popen([build / 'bin/lookout-page', '--config', config], stderr=subprocess.STDOUT, stdout=subprocess.PIPE, text=True)
    try:
        for line in page.stdout:
            if ': starts, version ' in line:
                break
        viewer = subprocess.Popen(['node', npm / 'view_live.mjs', str(PORT), file, protocol], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        begun = viewer.stderr.readline()
        assert begun == 'looking\n', begun + viewer.communicate(timeout=10)[1]
        subprocess.run(['sleep', '1'], check=True)
        subprocess.run(['lcm-logplayer', log], stdout=subprocess.DEVNULL, check=True)
        said, faults = viewer.communicate(timeout=90)
        assert viewer.returncode == 0, faults
        return json.loads(said)
    finally:
        page.send_signal(signal.SIGTERM)
        page.communicate(timeout=10)


def main():
    shutil.copytree(source / 'config/demo', config)
    with open(config / 'page.txtpb', 'a') as text:
        text.write(f'look_back_minutes: 0 token_file: "token"\nfoxglove {{ port: {PORT} }}\n')
    run('sim', '--config', config, '--scene', 'crossing', '--seed', '2', '--seconds', '12', '--pcap', work / 'sim.pcap')
    log, file = work / 'day.lcmlog', work / 'day.mcap'
    run('replay', '--config', config, '--in', work / 'sim.pcap', '--out', log)
    run('export', '--in', log, '--format', 'mcap', '--out', file)
    shutil.copy(source / 'tests/formats/view_live.mjs', npm)
    for protocol in ('foxglove.sdk.v1', 'foxglove.websocket.v1'):
        seen = look(log, file, protocol)
        assert seen['protocol'] == protocol, seen
        assert {'/lidar/points', '/obstacles', '/tracks', '/tracks/map', '/location', '/motion', '/tf', '/alerts'} == set(seen['topics']), seen['topics'].keys()
        for topic, row in seen['topics'].items():
            # The player begins late by some messages, and a busy computer loses a few.
            assert row['known'] == row['live'] and row['live'] > 0.8 * row['inFile'], (topic, row)
        assert len(seen['refused']) == 5 and all(one.startswith('2 this server only shows') for one in seen['refused']), seen['refused']
        print(f"{protocol}: {sum(row['live'] for row in seen['topics'].values())} messages, as they stand in the file")
    shutil.rmtree(work)


main()
