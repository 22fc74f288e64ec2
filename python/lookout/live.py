"""Messages of a bus that runs: LCM over UDP multicast, in pure Python."""
import re
import select
import socket
import struct
import time

from . import types
from .log import Event

DEFAULT_URL = 'udpm://239.255.76.67:7667?ttl=0'
_SHORT, _FRAGMENT = 0x4C433032, 0x4C433033  # 'LC02', 'LC03'
_SHORT_HEAD = struct.Struct('>II')
_FRAGMENT_HEAD = struct.Struct('>IIIIHH')
_MOST_NAME_BYTES = 63
_MOST_MESSAGE_BYTES = 16 << 20
_MOST_WAITING_BYTES = 64 << 20
_MOST_WAITING = 100
_LONGEST_WAIT_S = 2.0
_RECEIVE_BUFFER_BYTES = 8 << 20


class _Partial:
    def __init__(self, size, num_fragments, now_s):
        self.data = bytearray(size)
        self.missing = set(range(num_fragments))
        self.num_fragments = num_fragments
        self.num_bytes = 0
        self.channel = None
        self.began_s = now_s


class Reassembler:
    """Datagrams in, messages out. Memory is bounded: of more than 100 unfinished messages, or 64 MB of them, the oldest are given up, as are those
    that wait for 2 s.

    `num_incomplete` counts messages of which a fragment did not come, `num_malformed` datagrams that are none of LCM, or contradict others."""

    def __init__(self):
        self._partials = {}  # by sender and number, the oldest first
        self._num_waiting_bytes = 0
        self.num_incomplete = 0
        self.num_malformed = 0

    def take(self, sender, datagram, now_s):
        """@return (channel, data) where the datagram completes a message, else None"""
        self._give_up_older_than(now_s - _LONGEST_WAIT_S)
        magic = int.from_bytes(datagram[:4], 'big')
        if magic == _SHORT and len(datagram) >= _SHORT_HEAD.size:
            channel, rest = _cut_channel(datagram[_SHORT_HEAD.size:])
            return self._malformed() if channel is None else (channel, rest)
        if magic == _FRAGMENT and len(datagram) >= _FRAGMENT_HEAD.size:
            return self._take_fragment(sender, datagram, now_s)
        return self._malformed()

    def _take_fragment(self, sender, datagram, now_s):
        _, number, size, offset, index, num_fragments = _FRAGMENT_HEAD.unpack_from(datagram)
        data, channel = datagram[_FRAGMENT_HEAD.size:], None
        if index == 0:
            channel, data = _cut_channel(data)
            if channel is None:
                return self._malformed()
        if size > _MOST_MESSAGE_BYTES or index >= num_fragments or offset + len(data) > size:
            return self._malformed()
        key = (sender, number)
        partial = self._partials.get(key)
        if partial is not None and (len(partial.data) != size or partial.num_fragments != num_fragments):
            self._give_up(key)
            partial = None
            self.num_malformed += 1
        if partial is None:
            while self._partials and (len(self._partials) >= _MOST_WAITING or self._num_waiting_bytes + size > _MOST_WAITING_BYTES):
                self._give_up(next(iter(self._partials)))
            partial = self._partials[key] = _Partial(size, num_fragments, now_s)
            self._num_waiting_bytes += size
        if index not in partial.missing:
            return None  # it came twice
        partial.missing.discard(index)
        partial.data[offset:offset + len(data)] = data
        partial.num_bytes += len(data)
        partial.channel = channel or partial.channel
        if partial.missing:
            return None
        self._forget(key)
        if partial.num_bytes != size:
            return self._malformed()
        return partial.channel, bytes(partial.data)

    def _give_up_older_than(self, time_s):
        while self._partials:
            key = next(iter(self._partials))
            if self._partials[key].began_s >= time_s:
                return
            self._give_up(key)

    def _give_up(self, key):
        self.num_incomplete += 1
        self._forget(key)

    def _forget(self, key):
        self._num_waiting_bytes -= len(self._partials.pop(key).data)

    def _malformed(self):
        self.num_malformed += 1


def _cut_channel(data):
    end = data.find(b'\0', 0, _MOST_NAME_BYTES + 1)
    if end < 1:
        return None, data
    return data[:end].decode('utf-8', 'replace'), data[end + 1:]


class LiveReader:
    """Iterates over the events of a bus, as LogReader over those of a log; numbered from 0. What the buffers of the kernel lost is not counted."""

    def __init__(self, url=DEFAULT_URL, timeout_s=None):
        """@param timeout_s: the iteration ends where nothing comes for so long; None: never"""
        address = re.fullmatch(r'udpm://(\d+\.\d+\.\d+\.\d+):(\d+)(\?.*)?', url)
        if address is None:
            raise ValueError(f'{url} is no LCM address, as {DEFAULT_URL}')
        group, port = address.group(1), int(address.group(2))
        self._timeout_s = timeout_s
        self._number = 0
        self.reassembler = Reassembler()
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM, socket.IPPROTO_UDP)
        try:
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BUFFER_BYTES)
            self._socket.bind((group, port))  # datagrams to the group alone
            self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(group) + socket.inet_aton('0.0.0.0'))
            self._socket.setblocking(False)
        except OSError:
            self._socket.close()
            raise

    def close(self):
        self._socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __iter__(self):
        last_s = time.monotonic()
        while True:
            left_s = None if self._timeout_s is None else max(0.0, self._timeout_s - (time.monotonic() - last_s))
            if not select.select([self._socket], [], [], left_s)[0]:
                return
            try:
                datagram, sender = self._socket.recvfrom(65536)
            except BlockingIOError:
                continue
            made = self.reassembler.take(sender, datagram, time.monotonic())
            if made is None:
                continue
            last_s = time.monotonic()
            yield Event(self._number, time.time_ns() // 1000, *made)
            self._number += 1


def live_messages(*channels, url=DEFAULT_URL, timeout_s=None):
    """Iterates over (event, message) of a bus, as `messages` over those of a log. What is of no known type, or does not decode, is left out.

    @param timeout_s: ends where nothing comes on the bus for so long; None: never"""
    with LiveReader(url, timeout_s) as bus:
        for event in bus:
            if channels and event.channel not in channels:
                continue
            made = types.this_version.by_fingerprint(int.from_bytes(event.data[:8], 'big')) if len(event.data) >= 8 else None
            if made is None:
                continue
            try:
                yield event, made.decode(event.data)
            except types.DecodeError:
                continue
