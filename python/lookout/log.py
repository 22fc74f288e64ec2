"""lcm-logs: read and written event by event."""
import os
import struct
import typing

from . import types

_HEAD = struct.Struct('>IqqII')
_SYNC = 0xEDA1DA01
_SYNC_BYTES = struct.pack('>I', _SYNC)
_MOST_NAME_BYTES = 63  # LCM; its logs allow more
_MOST_NAME_BYTES_READ = 1000
_MOST_DATA_BYTES = 16 << 20
_LEAST_TIME_US, _MOST_TIME_US = -2_208_988_800_000_000, 7_258_118_400_000_000  # the years 1900 to 2200
_BLOCK_BYTES = 1 << 20


class Event(typing.NamedTuple):
    number: int
    time_us: int  # when it was received; in a log that was replayed, of the raw message that it came of
    channel: str
    data: bytes


class LogReader:
    """Iterates over the events of a log. Damaged stretches, and events of more than 16 MiB, are skipped and counted in `num_damaged`."""

    def __init__(self, path):
        self._file = open(path, 'rb')
        self._size = os.fstat(self._file.fileno()).st_size
        self._block_at, self._block = 0, b''
        self.num_damaged = 0

    def close(self):
        self._file.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __iter__(self):
        at, is_lost = 0, False
        while True:
            event, end = self._read(at)
            if event is not None:
                is_lost = False
                at = end
                yield event
                continue
            if at >= self._size:
                return
            self.num_damaged += 0 if is_lost else 1
            is_lost = True
            at = self._find_sync(at + 1)

    def _read(self, at):
        self._file.seek(at)
        head = self._file.read(_HEAD.size)
        if len(head) < _HEAD.size:
            return None, at
        sync, number, time_us, num_name, num_data = _HEAD.unpack(head)
        end = at + _HEAD.size + num_name + num_data
        is_sound = sync == _SYNC and 0 < num_name <= _MOST_NAME_BYTES_READ and num_data <= _MOST_DATA_BYTES and end <= self._size
        if not is_sound or not _LEAST_TIME_US <= time_us <= _MOST_TIME_US:
            return None, at
        body = self._file.read(num_name + num_data)
        # A damaged length that fits in the file would swallow the events behind it: then none begins at its end, but some within.
        if end < self._size and self._file.read(len(_SYNC_BYTES)) != _SYNC_BYTES and _SYNC_BYTES in body:
            return None, at
        return Event(number, time_us, body[:num_name].decode('utf-8', 'replace'), body[num_name:]), end

    def _find_sync(self, at):
        while at < self._size:
            if not self._block_at <= at < self._block_at + len(self._block) - len(_SYNC_BYTES) + 1:
                self._file.seek(at)
                self._block_at, self._block = at, self._file.read(_BLOCK_BYTES)
                if len(self._block) < len(_SYNC_BYTES):
                    break
            found = self._block.find(_SYNC_BYTES, at - self._block_at)
            if found >= 0:
                return self._block_at + found
            at = self._block_at + len(self._block) - len(_SYNC_BYTES) + 1
        return self._size


class LogWriter:
    """Writes a log. Events are numbered from 0."""

    def __init__(self, path):
        """@raise FileExistsError: nothing is written over"""
        self._file = open(path, 'xb')
        self._number = 0

    def write(self, time_us, channel, data):
        """@param data: bytes, or a message"""
        if isinstance(data, types.Message):
            data = data.encode()
        name = channel.encode()
        if not 0 < len(name) <= _MOST_NAME_BYTES:
            raise ValueError(f'the name of a channel has 1 to {_MOST_NAME_BYTES} bytes')
        self._file.write(_HEAD.pack(_SYNC, self._number, time_us, len(name), len(data)) + name + data)
        self._number += 1

    def close(self):
        self._file.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def types_of_log(path):
    """The types that the log's first RUN_INFO describes: those of the version that wrote it. Those of this version where there is none.

    @raise DecodeError: the description cannot be read"""
    with LogReader(path) as log:
        for event in log:
            if event.channel != 'RUN_INFO':
                continue
            try:
                info = types.this_version.run_info_t.decode(event.data)
            except types.DecodeError:
                continue
            texts = [text for name, text in zip(info.file_name, info.file_text) if name.startswith('lcmtypes/')]
            if texts:
                try:
                    return types.Types(texts)
                except (AttributeError, KeyError, ValueError, IndexError) as error:
                    raise types.DecodeError(f'RUN_INFO describes types that cannot be read: {error}') from error
    return types.this_version


def messages(path, *channels, of_types=None):
    """Iterates over (event, message) of these channels, or of all. What is of no known type, or does not decode, is left out.

    @param of_types: types_of_log(path), or those of this version where it is not given"""
    known = of_types or types.this_version
    with LogReader(path) as log:
        for event in log:
            if channels and event.channel not in channels:
                continue
            made = known.by_fingerprint(int.from_bytes(event.data[:8], 'big')) if len(event.data) >= 8 else None
            if made is None:
                continue
            try:
                yield event, made.decode(event.data)
            except types.DecodeError:
                continue
