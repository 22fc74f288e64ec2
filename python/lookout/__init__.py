"""Logs of Lookout in Python: lcm-logs read and written, messages with types, tables as numpy arrays.

    import lookout
    obstacles = lookout.table('day.lcmlog', 'OBSTACLES', 'obstacles')
    for event, scan in lookout.messages('day.lcmlog', 'LIDAR_SCAN'):
        points = lookout.scan_points(scan)
"""
from .log import Event, LogReader, LogWriter, messages, types_of_log
from .tables import scan_points, table
from .types import DecodeError, Message, Types
from .types import this_version as message_types

__all__ = ['DecodeError', 'Event', 'LogReader', 'LogWriter', 'Message', 'Types', 'message_types', 'messages', 'scan_points', 'table', 'types_of_log']
