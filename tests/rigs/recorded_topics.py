#!/usr/bin/env python3
"""Checks the topics for other tools in recordings with the readers and definitions of others.

Usage: python tests/rigs/recorded_topics.py RECORDING...

The definitions in the files have the hashes of the standard ones (RIHS01), of every distribution of ROS 2
that has such hashes. Every message is decoded by the standard definition and by the one in the file, has the
bytes that rosbags writes for it, and the numbers that follow from the recorder's own topics, computed here
with NumPy. Every path of the layouts of Foxglove and PlotJuggler has finite values in one of the recordings.

Needs the packages of tests/rigs/requirements-export.txt. Exit status: 0 as expected, 1 with the assertion
that doesn't hold.
"""

import collections
import json
import math
import sys
from pathlib import Path

import numpy as np
from lxml import etree
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"
STANDARD = {
    "/imu/data": "sensor_msgs/msg/Imu",
    "/fix": "sensor_msgs/msg/NavSatFix",
    "/error/position": "geometry_msgs/msg/Vector3Stamped",
    "/error/velocity": "geometry_msgs/msg/Vector3Stamped",
    "/error/attitude": "geometry_msgs/msg/Vector3Stamped",
}
# Distributions whose types have a hash.
DISTRIBUTIONS = [Stores.ROS2_HUMBLE, Stores.ROS2_IRON, Stores.ROS2_JAZZY, Stores.ROS2_KILTED]
# Axes north, east, down in those of east, north, up; forward, right, down in forward, left, up.
ENU = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]], float)
FLU = np.diag([1.0, -1.0, -1.0])
EARTH_RADIUS_M, ECCENTRICITY_SQUARED = 6378137.0, 6.69437999014e-3


def check_definitions(schemas):
    """The definitions in the file are the standard ones, by their hashes."""
    for topic, name in STANDARD.items():
        schema = schemas[topic]
        assert (schema.name, schema.encoding) == (name, "ros2msg"), (topic, schema.name)
        ours = get_typestore(Stores.EMPTY)
        ours.register(get_types_from_msg(schema.data.decode(), name))
        for distribution in DISTRIBUTIONS:
            standard = get_typestore(distribution)
            for kind in ours.fielddefs:
                found, wanted = ours.hash_rihs01(kind), standard.hash_rihs01(kind)
                assert found == wanted, f"{topic}: {kind} is {found}, {distribution.name} has {wanted}"
    names = ", ".join(f"{name} {get_typestore(DISTRIBUTIONS[0]).hash_rihs01(name)[:15]}" for name in sorted(set(STANDARD.values())))
    print(f"definitions: {names}, as in {', '.join(d.name for d in DISTRIBUTIONS)}")


def rotation(w, x, y, z):
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


def symmetric(upper):
    matrix = np.zeros((3, 3))
    matrix[np.triu_indices(3)] = upper
    return matrix + np.triu(matrix, 1).T


def near(found, wanted, tolerance, what):
    worst = np.max(np.abs(np.asarray(found, float) - np.asarray(wanted, float)))
    assert worst <= tolerance, f"{what}: {found}, from the recording {wanted}"


def vector(v):
    return np.array([v.x, v.y, v.z])


class Epochs:
    """Messages of the recorder's own topics by log time; the last of each time."""

    def __init__(self, path):
        self.of = collections.defaultdict(dict)
        with open(path, "rb") as file:
            reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
            own = ["/imu", "/output", "/truth", "/covariance"]
            for _, channel, message, decoded in reader.iter_decoded_messages(topics=own, log_time_order=False):
                self.of[message.log_time][channel.topic] = decoded
        numbers = [(e["/imu"].sequence, t) for t, e in self.of.items() if "/imu" in e]
        (n, t), (m, u) = min(numbers), max(numbers)
        self.interval_s = (u - t) / (m - n) * 1e-9


def check_imu(imu, epoch, interval_s):
    sample, output = epoch["/imu"], epoch["/output"]
    for found, counts, lsb in (
        (imu.angular_velocity, sample.delta_theta, 2.0**-36),
        (imu.linear_acceleration, sample.delta_velocity, 2.0**-30),
    ):
        wanted = FLU @ np.array(counts, float) * lsb / interval_s
        near(vector(found), wanted, 1e-9 * (1 + np.max(np.abs(wanted))), "rates")
    q = imu.orientation
    near(rotation(q.w, q.x, q.y, q.z), ENU @ rotation(*output.q_nb) @ FLU, 1e-11, "orientation")
    covariance = epoch.get("/covariance")
    wanted = np.zeros((3, 3)) if covariance is None else ENU @ symmetric(covariance.attitude_rad2) @ ENU.T
    near(np.reshape(imu.orientation_covariance, (3, 3)), wanted, 0, "covariance of the orientation")
    # Zeros are an unknown covariance.
    assert not np.any(imu.angular_velocity_covariance) and not np.any(imu.linear_acceleration_covariance)


def check_fix(fix, epoch):
    output, covariance = epoch["/output"], epoch.get("/covariance")
    near(fix.latitude, math.degrees(output.latitude_rad), 1e-13, "latitude")
    near(fix.longitude, math.degrees(output.longitude_rad), 1e-13, "longitude")
    assert fix.altitude == output.height_m
    assert fix.status.status == (0 if output.mode in (1, 3, 4) else -1), (fix.status, output.mode)
    known = covariance is not None and fix.status.status == 0
    wanted = ENU @ symmetric(covariance.position_m2) @ ENU.T if known else np.zeros((3, 3))
    near(np.reshape(fix.position_covariance, (3, 3)), wanted, 0, "covariance of the position")
    assert fix.position_covariance_type == (fix.COVARIANCE_TYPE_KNOWN if known else fix.COVARIANCE_TYPE_UNKNOWN)
    if known:
        assert np.all(np.linalg.eigvalsh(wanted) > 0), wanted


def errors(epoch):
    """Errors of the solution in east, north, up: m, m/s, rad."""
    output, truth = epoch["/output"], epoch["/truth"]
    sine = math.sin(truth.latitude_rad)
    root = 1 - ECCENTRICITY_SQUARED * sine * sine
    across_m = EARTH_RADIUS_M / math.sqrt(root) + truth.height_m
    along_m = EARTH_RADIUS_M * (1 - ECCENTRICITY_SQUARED) / root**1.5 + truth.height_m
    position = [
        (output.longitude_rad - truth.longitude_rad) * across_m * math.cos(truth.latitude_rad),
        (output.latitude_rad - truth.latitude_rad) * along_m,
        output.height_m - truth.height_m,
    ]
    velocity = ENU @ (np.array(output.velocity_mps) - np.array(truth.velocity_mps))
    turn = rotation(*output.q_nb) @ rotation(*truth.q_nb).T
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    size = np.linalg.norm(axis)
    # The angle of a small turn is the arc sine of the length.
    attitude = axis * (math.asin(min(size, 1.0)) / size if size > 0 else 1.0)
    return {"/error/position": position, "/error/velocity": velocity, "/error/attitude": ENU @ attitude}


def check_messages(path):
    """Every standard message against the recorder's own; the counts by topic."""
    epochs, store = Epochs(path), get_typestore(Stores.ROS2_JAZZY)
    counts, known, schemas = collections.Counter(), 0, {}
    factory = DecoderFactory()
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        for schema, channel, message in reader.iter_messages(topics=list(STANDARD)):
            topic, name = channel.topic, STANDARD[channel.topic]
            counts[topic] += 1
            schemas[topic] = schema
            decoded = store.deserialize_cdr(message.data, name)
            assert bytes(store.serialize_cdr(decoded, name)) == message.data, f"{topic}: other bytes"
            by_file = factory.decoder_for(channel.message_encoding, schema)(message.data)
            assert by_file.header.frame_id == decoded.header.frame_id
            stamp = decoded.header.stamp
            assert stamp.sec * 10**9 + stamp.nanosec == message.log_time
            epoch = epochs.of[message.log_time]
            if topic == "/imu/data":
                assert decoded.header.frame_id == "imu_link"
                check_imu(decoded, epoch, epochs.interval_s)
                continue
            assert decoded.header.frame_id == "enu"
            if topic == "/fix":
                check_fix(decoded, epoch)
                known += decoded.position_covariance_type != 0
                continue
            wanted = errors(epoch)[topic]
            near(vector(decoded.vector), wanted, 1e-14 + 1e-11 * np.max(np.abs(wanted)), topic)
    check_definitions(schemas)
    told = ", ".join(f"{topic} {count}" for topic, count in sorted(counts.items()))
    print(f"{path.parent.name}: {told}; {known} positions with a covariance: as in the recorder's own topics")
    return known


def values(path):
    """Values on every topic by path, with dots between the fields."""
    found = collections.defaultdict(list)

    def walk(at, value):
        if isinstance(value, dict):
            for name, part in value.items():
                walk(f"{at}.{name}", part)
        elif hasattr(value, "__slots__"):
            for name in value.__slots__:
                walk(f"{at}.{name}", getattr(value, name))
        elif value is not None:
            found[at].append(value)

    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for schema, channel, message in reader.iter_messages():
            if channel.message_encoding == "json":
                content = json.loads(message.data)
                known = json.loads(schema.data)["properties"]
                assert set(content) <= set(known), f"{channel.topic}: {set(content) - set(known)} has no schema"
                walk(channel.topic, content)
                found[channel.topic].append(content)
        for _, channel, _, decoded in reader.iter_decoded_messages(topics=list(STANDARD)):
            walk(channel.topic, decoded)
            found[channel.topic].append(decoded)
    return found


def strings(value):
    if isinstance(value, str):
        yield value
    elif isinstance(value, (list, dict)):
        for part in value.values() if isinstance(value, dict) else value:
            yield from strings(part)


def check_layouts(recordings):
    found = collections.defaultdict(list)
    for path in recordings:
        for name, seen in values(path).items():
            found[name] += seen
    foxglove = json.loads((FIXTURES / "foxglove/octant-layout.json").read_text())
    shown = [text for text in strings(foxglove["configById"]) if text.startswith("/")]
    root = etree.parse(str(FIXTURES / "plotjuggler/octant-layout.xml"))
    plotted = root.xpath("//curve/@name")
    for layout, paths, separator in (("Foxglove", shown, "."), ("PlotJuggler", plotted, "/")):
        assert len(paths) > 40, layout
        for path in paths:
            topics = [topic for topic in found if path == topic or path.startswith(topic + separator)]
            topic = max((t for t in topics if "." not in t), key=len, default=None)
            assert topic, f"{layout}: {path} has no topic"
            place = topic + path[len(topic):].replace(separator, ".")
            seen = found.get(place, [])
            numbers = [v for v in seen if isinstance(v, (int, float))]
            assert seen, f"{layout}: {path} has no value"
            assert all(math.isfinite(v) for v in numbers), f"{layout}: {path} isn't finite"
            # PlotJuggler plots numbers alone.
            assert numbers or layout == "Foxglove", f"{layout}: {path} is no number"
        print(f"{layout}: {len(paths)} paths with values")


def main():
    recordings = [Path(name) for name in sys.argv[1:]]
    known = [check_messages(path) for path in recordings]
    assert any(known), "no covariance in any recording"
    check_layouts(recordings)


if __name__ == "__main__":
    main()
