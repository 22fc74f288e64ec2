"""Types of messages as ROS defines them, made by genpy out of their texts: Debian has no velodyne_msgs and no nmea_msgs."""
import genpy.dynamic

HEADER = """
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
"""
VECTOR = """
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""
TEXTS = {
    'velodyne_msgs/VelodyneScan': 'Header header\nVelodynePacket[] packets\n' + HEADER + """
================================================================================
MSG: velodyne_msgs/VelodynePacket
time stamp
uint8[1206] data
""",
    'nmea_msgs/Sentence': 'Header header\nstring sentence\n' + HEADER,
    'sensor_msgs/Imu': """Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
""" + HEADER + VECTOR + """
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
""",
    'sensor_msgs/NavSatFix': """uint8 COVARIANCE_TYPE_UNKNOWN=0
Header header
NavSatStatus status
float64 latitude
float64 longitude
float64 altitude
float64[9] position_covariance
uint8 position_covariance_type
""" + HEADER + """
================================================================================
MSG: sensor_msgs/NavSatStatus
int8 STATUS_NO_FIX=-1
int8 status
uint16 service
""",
    'geometry_msgs/TwistStamped': 'Header header\nTwist twist\n' + HEADER + """
================================================================================
MSG: geometry_msgs/Twist
Vector3 linear
Vector3 angular
""" + VECTOR,
    'sensor_msgs/PointCloud2': """Header header
uint32 height
uint32 width
PointField[] fields
bool is_bigendian
uint32 point_step
uint32 row_step
uint8[] data
bool is_dense
""" + HEADER + """
================================================================================
MSG: sensor_msgs/PointField
string name
uint32 offset
uint8 datatype
uint32 count
""",
}


CLASSES = {}


def generated(name):
    """All classes of a type."""
    if name not in CLASSES:
        CLASSES[name] = genpy.dynamic.generate_dynamic(name, TEXTS[name])
    return CLASSES[name]


def ros2_texts():
    """The same types as ROS 2 has them: no number in the header, and a time of two numbers."""
    time = '\n' + '=' * 80 + '\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n'
    return {name: text.replace('uint32 seq\n', '').replace('time stamp', 'builtin_interfaces/Time stamp') + time for name, text in TEXTS.items()}

