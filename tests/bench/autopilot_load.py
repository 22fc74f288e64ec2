#!/usr/bin/env python3
"""The whole chain live on a simulated boat, and an autopilot on loopback that gets OBSTACLE_DISTANCE from lookout-plotter.

    autopilot_load.py BUILD_FOLDER CONFIG_FOLDER [SECONDS [SCENE]]

Run it in a network namespace with a route for multicast on lo. Prints how late distances are (from the last shot of their scan to the datagram, both by
this computer's clock: the lidar's is set to stamp by it), how evenly they come, how many sectors are unknown, and the plotter's share of a core with
that output and without.
"""

import os
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time

# Readers first: nobody misses a first message.
PROCESSES = ('plotter', 'tracker', 'georeferencer', 'segmenter', 'odometer', 'navigator', 'lidar')
PORT = 14550
OUTPUT = 'output { name: "pilot" format: MAVLINK udp { address: "127.0.0.1" port: %d } }\n' % PORT
SETTLE_S = 5.0


def cpu_s(pid):
    with open('/proc/%d/stat' % pid, encoding='ascii') as file:
        words = file.read().rpartition(')')[2].split()
    return (int(words[11]) + int(words[12])) / os.sysconf('SC_CLK_TCK')


def at(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))] if values else float('nan')


def receive(receiver, seconds):
    datagrams = []
    end_s = time.time() + seconds
    while time.time() < end_s:
        try:
            datagram = receiver.recv(2048)
        except socket.timeout:
            continue
        datagrams.append((time.time(), datagram))
    return datagrams


def run(build, config, seconds, scene, output):
    """@return share of a core of the plotter; datagrams with their times of arrival"""
    children = []
    receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    receiver.bind(('127.0.0.1', PORT))
    receiver.settimeout(0.2)
    with tempfile.TemporaryDirectory() as folder:
        boat = os.path.join(folder, 'config')
        shutil.copytree(config, boat)
        plotter = os.path.join(boat, 'plotter.txtpb')
        os.remove(plotter)
        if output:
            with open(plotter, 'w', encoding='utf-8') as file:
                file.write(output)
        with open(os.path.join(boat, 'lidar.txtpb'), 'a', encoding='utf-8') as file:
            file.write('\ntime_source: TIME_HOST\n')
        try:
            for name in PROCESSES:
                with open(os.path.join(folder, name + '.out'), 'w', encoding='utf-8') as out:
                    children.append(subprocess.Popen([os.path.join(build, 'bin/lookout-' + name), '--config', boat], stdout=out, stderr=out))
            time.sleep(2.0)
            for name, child in zip(PROCESSES, children):
                if child.poll() is not None:
                    with open(os.path.join(folder, name + '.out'), encoding='utf-8') as out:
                        sys.exit('lookout-%s ended: %s' % (name, out.read()))
            simulator = subprocess.Popen([os.path.join(build, 'bin/lookout-sim'), '--config', boat, '--scene', scene, '--seed', '1', '--seconds',
                                          str(int(seconds + 2 * SETTLE_S)), '--udp', '127.0.0.1'], stdout=subprocess.DEVNULL)
            children.append(simulator)
            receive(receiver, SETTLE_S)
            begin_s, begin_cpu_s = time.time(), cpu_s(children[0].pid)
            datagrams = receive(receiver, seconds)
            share = (cpu_s(children[0].pid) - begin_cpu_s) / (time.time() - begin_s)
        finally:
            for child in children:
                child.terminate()
            for child in children:
                child.wait(15)
            receiver.close()
    return share, datagrams


def main():
    build, config = sys.argv[1], sys.argv[2]
    seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 60.0
    scene = sys.argv[4] if len(sys.argv) > 4 else 'lake'
    share, datagrams = run(build, config, seconds, scene, OUTPUT)
    alone, _ = run(build, config, min(seconds, 20.0), scene, '')
    looks = [(time_s, datagram[10:-2].ljust(167, b'\0')) for time_s, datagram in datagrams if int.from_bytes(datagram[7:10], 'little') == 330]
    if not looks:
        sys.exit('no OBSTACLE_DISTANCE came')
    late_ms = [1e3 * (time_s - struct.unpack_from('<Q', payload)[0] * 1e-6) for time_s, payload in looks]
    apart_ms = [1e3 * (after[0] - before[0]) for before, after in zip(looks, looks[1:])]
    unknown = [struct.unpack_from('<72H', payload, 8).count(65535) for _, payload in looks]
    print('%s, %.0f s: %d looks' % (scene, seconds, len(looks)))
    print('from the last shot to the datagram: median %.1f ms, p99 %.1f ms, most %.1f ms' % (at(late_ms, 0.5), at(late_ms, 0.99), max(late_ms)))
    print('apart: median %.1f ms, 1 %% below %.1f ms, 99 %% below %.1f ms, most %.1f ms; within 20 ms of 100 ms: %.1f %%'
          % (at(apart_ms, 0.5), at(apart_ms, 0.01), at(apart_ms, 0.99), max(apart_ms),
             100.0 * sum(abs(one - 100.0) <= 20.0 for one in apart_ms) / len(apart_ms)))
    print('unknown sectors: mean %.2f, looks without any %d' % (sum(unknown) / len(unknown), sum(one == 0 for one in unknown)))
    print('lookout-plotter: %.1f %% of a core; without an output %.1f %%' % (100.0 * share, 100.0 * alone))


if __name__ == '__main__':
    main()
