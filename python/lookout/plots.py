"""Pictures with matplotlib, which is needed for them alone."""
from . import tables


def plot_scan(scan, axes=None, colour_by='reflectivity', longest_m=None):
    """Draws the returns of a LIDAR_SCAN message (or part) from above: the lidar in the middle, its x axis up, y to the left.

    @param axes: of matplotlib; new ones where it is not given
    @param colour_by: a column of scan_points
    @param longest_m: how far the picture reaches; as far as the returns where it is not given
    @return the axes"""
    if axes is None:
        try:
            from matplotlib import pyplot
        except ImportError as error:
            raise ImportError('plot_scan needs matplotlib: apt-get install python3-matplotlib') from error
        axes = pyplot.figure(figsize=(8, 8)).add_subplot()
    points = tables.scan_points(scan)
    dots = axes.scatter(-points['y_m'], points['x_m'], c=points[colour_by], s=1, cmap='viridis')
    axes.figure.colorbar(dots, label=colour_by, shrink=0.7)
    axes.plot([0], [0], marker='^', color='black')
    axes.set_aspect('equal')
    axes.set_xlabel('to the right of the lidar, m')
    axes.set_ylabel('ahead of the lidar, m')
    axes.set_title(f'scan {scan.seq}: {len(points)} returns')
    if longest_m is not None:
        axes.set_xlim(-longest_m, longest_m)
        axes.set_ylim(-longest_m, longest_m)
    return axes
