"""Tables of a log as numpy arrays with a name for each column."""
import numpy

from . import log


def table(path, channel, part=None, of_types=None):
    """A row for each message of a channel, or for each of the messages in it.

    @param part: the name of a member that is a list of messages: 'obstacles' of OBSTACLES, 'tracks' of TRACKS. Rows then begin with `scan_utime_us`
                 and `scan_seq`, those of the message.
    @return a structured array: numbers and texts of the rows; arrays of one dimension and fixed length as columns with that shape. Members of other
            lengths are left out. Empty where the log holds nothing of it"""
    rows, columns = [], None
    for _, message in log.messages(path, channel, of_types=of_types):
        for row in (getattr(message, part, []) if part else [message]):
            if columns is None:
                columns, kind_of_row = _columns_of(row), type(row)
            if type(row) is not kind_of_row:
                continue  # another type that came on the channel
            values = tuple(_value(getattr(row, name)) for name, _ in columns)
            rows.append((message.utime_us, message.seq) + values if part else values)
    if columns is None:
        return numpy.zeros(0, [('utime_us', '<i8')])
    texts = [i for i, (_, kind) in enumerate(columns) if kind is str]
    layout = [('scan_utime_us', '<i8'), ('scan_seq', '<i8')] if part else []
    offset = len(layout)
    for i, (name, kind) in enumerate(columns):
        longest = max((len(row[offset + i]) for row in rows), default=1) if i in texts else 0
        layout.append((name, f'<U{max(1, longest)}') if i in texts else (name, *kind))
    return numpy.array(rows, layout)


def _columns_of(message):
    columns = []
    for field in message.fields:
        fixed = [size for size in field.sizes if isinstance(size, int)]
        if len(fixed) < len(field.sizes) or field.message_type is not None:
            continue
        if field.kind == 'string':
            if not field.sizes:
                columns.append((field.name, str))
        else:
            columns.append((field.name, (field.dtype.newbyteorder('<'), tuple(fixed)) if fixed else (field.dtype.newbyteorder('<'),)))
    return columns


def _value(value):
    return value.tolist() if isinstance(value, numpy.ndarray) else value


def scan_points(scan):
    """Returns of a LIDAR_SCAN message (or part): a structured array of x_m, y_m, z_m (lidar frame: x forward, y left, z up), range_m, azimuth_rad,
    ring, reflectivity, time_ns since the begin of the scan; by column, then ring, then return."""
    shape = (scan.num_columns, scan.num_rings, scan.num_returns)
    counts = scan.range.view(numpy.uint16).reshape(shape)
    column, ring, number = numpy.nonzero(counts)
    points = numpy.zeros(len(column), [('x_m', '<f8'), ('y_m', '<f8'), ('z_m', '<f8'), ('range_m', '<f8'), ('azimuth_rad', '<f8'), ('ring', '<i4'),
                                       ('reflectivity', 'u1'), ('time_ns', '<i8')])
    points['range_m'] = counts[column, ring, number] * scan.range_unit_m
    points['azimuth_rad'] = scan.azimuth_rad[column].astype(float) + scan.azimuth_offset_rad[ring]
    elevation_rad = scan.elevation_rad[ring].astype(float)
    level_m = points['range_m'] * numpy.cos(elevation_rad)
    points['x_m'] = level_m * numpy.cos(points['azimuth_rad'])
    points['y_m'] = -level_m * numpy.sin(points['azimuth_rad'])
    points['z_m'] = points['range_m'] * numpy.sin(elevation_rad) + scan.origin_height_m[ring]
    points['ring'] = ring
    points['reflectivity'] = scan.reflectivity.view(numpy.uint8).reshape(shape)[column, ring, number]
    points['time_ns'] = scan.time_ns[column].astype(numpy.int64) + scan.time_offset_ns[ring]
    return points
