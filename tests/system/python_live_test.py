"""The package `lookout` on a bus: what LCM's own player sends is received, whole and in fragments; fragments are put together within bounds.
  python_live_test.py LOG EXAMPLE WORK_FOLDER"""
import pathlib
import struct
import subprocess
import sys
import threading

import lookout

log, example, work = (pathlib.Path(argument) for argument in sys.argv[1:4])


def short(channel, data, number=1):
    return struct.pack('>II', 0x4C433032, number) + channel + b'\0' + data


def fragment(number, size, offset, index, count, data):
    return struct.pack('>IIIIHH', 0x4C433033, number, size, offset, index, count) + data


# Without a network: each datagram by hand.
parts = lookout.Reassembler()
assert parts.take('a', short(b'POSE', b'12'), 0) == ('POSE', b'12')
assert parts.take('a', short(b'X' * 63, b''), 0) == ('X' * 63, b'')
assert parts.take('a', fragment(7, 5, 3, 1, 2, b'de'), 0) is None
assert parts.take('b', fragment(7, 5, 0, 0, 2, b'SCAN\0xyz'), 0) is None  # the same number of another sender
assert parts.take('a', fragment(7, 5, 3, 1, 2, b'de'), 0) is None  # twice
assert parts.take('a', fragment(7, 5, 0, 0, 2, b'SCAN\0abc'), 0) == ('SCAN', b'abcde')
assert (parts.num_incomplete, parts.num_malformed) == (0, 0)
assert parts.take('a', short(b'POSE', b''), 2.5) == ('POSE', b'') and parts.num_incomplete == 1  # b's has waited for too long
wrong = [b'', b'LC', b'LC02', b'LC04' + bytes(40), short(b'', b'1'), short(b'X' * 64, b'1'), short(b'', b'')[:-1], fragment(1, 5, 0, 2, 2, b'x'),
         fragment(1, 5, 4, 1, 2, b'xy'), fragment(1, 2 ** 32 - 1, 0, 1, 2, b'x'), fragment(1, 5, 0, 0, 2, b'without an end'), fragment(1, 1, 0, 0, 0, b'A\0x')]
for number, datagram in enumerate(wrong):
    assert parts.take('a', datagram, 3) is None and parts.num_malformed == number + 1, datagram
# Two messages under one number; fragments that overlap and leave a gap.
parts = lookout.Reassembler()
parts.take('a', fragment(1, 4, 0, 0, 2, b'A\0xx'), 0)
assert parts.take('a', fragment(1, 6, 3, 1, 2, b'yyy'), 0) is None and (parts.num_incomplete, parts.num_malformed) == (1, 1)
parts.take('a', fragment(2, 4, 0, 0, 2, b'A\0x'), 0)
assert parts.take('a', fragment(2, 4, 3, 1, 2, b'y'), 0) is None and parts.num_malformed == 2
# A flood of fragments without their rest takes no more than its bound.
parts = lookout.Reassembler()
for number in range(1000):
    parts.take('a', fragment(number, 1 << 20, 0, 0, 2, b'A\0x'), 0)
assert len(parts._partials) <= 64 and parts._num_waiting_bytes <= 64 << 20 and parts.num_incomplete >= 900
for number in range(1000):
    parts.take('b', fragment(number, 10, 0, 0, 2, b'A\0x'), 0)
assert len(parts._partials) == 100

for wrong in ('', 'file://x', 'udpm://localhost:7667', 'memq://'):
    try:
        lookout.LiveReader(wrong)
        raise AssertionError(f'{wrong} is a bus')
    except ValueError:
        pass

# LCM's player: messages of all lengths, then those of a log.
sent = {}
with lookout.LogWriter(work / 'sent.lcmlog') as writer:
    for number, size in enumerate((0, 1, 1000, 65_000, 65_499, 65_500, 65_507, 70_000, 131_000, 1_000_000)):
        sent[f'SIZE_{number}'] = bytes((number + i) % 251 for i in range(size))
        writer.write(1_700_000_000_000_000 + 20_000 * number, f'SIZE_{number}', sent[f'SIZE_{number}'])
received = {}


def receive(reader):
    for event in reader:
        received[event.channel] = event.data
        if event.channel == 'SIZE_9':
            return


def play(path):
    subprocess.run(['lcm-logplayer', '--lcm-url', lookout.DEFAULT_URL, path], check=True, stdout=subprocess.DEVNULL)


with lookout.LiveReader(timeout_s=10) as reader:
    thread = threading.Thread(target=receive, args=(reader,))
    thread.start()
    play(work / 'sent.lcmlog')
    thread.join()
    assert received == sent, {channel: len(data) for channel, data in received.items()}
    assert reader.reassembler.num_malformed == 0 and reader.reassembler.num_incomplete == 0

# The example of the page. It takes a moment to start: the log is played more than once.
with subprocess.Popen([sys.executable, '-u', example, '4'], stdout=subprocess.PIPE, text=True) as child:
    for _ in range(3):
        play(log)
    text, _ = child.communicate(timeout=30)
assert child.returncode == 0 and ' tracks, ' in text and ' alerts' in text, text
print(f'{len(received)} messages of all lengths, {text.count(chr(10))} of a log')
