"""Logs of Lookout in Python: lcm-logs read and written, messages with types, tables as numpy arrays; live messages.

    import lookout
    obstacles = lookout.table('day.lcmlog', 'OBSTACLES', 'obstacles')
    for event, scan in lookout.messages('day.lcmlog', 'LIDAR_SCAN'):
        points = lookout.scan_points(scan)
"""
from .live import DEFAULT_URL, LiveReader, Reassembler, live_messages
from .log import Event, LogReader, LogWriter, messages, types_of_log
from .plots import plot_scan
from .tables import scan_points, table
from .types import DecodeError, Message, Types
from .types import this_version as message_types

__all__ = ['DEFAULT_URL', 'DecodeError', 'Event', 'LiveReader', 'LogReader', 'LogWriter', 'Message', 'Reassembler', 'Types', 'live_messages', 'message_types',
           'messages', 'plot_scan', 'scan_points', 'table', 'types_of_log']
