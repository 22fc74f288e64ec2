"""lcm-logs and the programs of Lookout."""
import hashlib
import struct
import subprocess


def run(bin_folder, program, *arguments, code=0):
    command = [str(bin_folder / f'lookout-{program}'), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == code, f'{command}: {done.returncode}\n{done.stdout}{done.stderr}'
    return done.stdout + done.stderr


def events(log):
    """Of an lcm-log: (channel, payload)."""
    data = log.read_bytes()
    at = 0
    while at < len(data):
        _, _, _, num_channel, num_data = struct.unpack_from('>IqqII', data, at)
        channel = data[at + 28:at + 28 + num_channel].decode()
        yield channel, data[at + 28 + num_channel:at + 28 + num_channel + num_data]
        at += 28 + num_channel + num_data


def digest(log, channel):
    sha = hashlib.sha256()
    for name, payload in events(log):
        if name == channel:
            sha.update(payload)
    return sha.hexdigest()
