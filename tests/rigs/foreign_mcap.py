#!/usr/bin/env python3
"""Reads bags and MCAP files of other programs with Octant, and compares every sample with NumPy.

Usage: python tests/rigs/foreign_mcap.py OCTANT FOLDER

rosbags writes the messages: sensor_msgs/Imu of ROS 1, and of ROS 2 with definitions as messages and in IDL, gyros and
accelerometers on one topic and on two. A bag of ROS 1 is refused with the command that converts it, and read behind this command.

Needs the packages of tests/rigs/requirements-export.txt. Exit status: 0 as expected, 1 with the assertion that doesn't hold.
"""

import subprocess
import sys
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap.writer import Writer
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

COUNT, PERIOD_NS, START_NS = 1000, 10_000_000, 1_700_000_000_000_000_000
LSB = {"delta_theta": 2.0**-36, "delta_velocity": 2.0**-30}
TOML = """schema = 1
title = "another program's file"
[imu]
rate = "100 Hz"
[procedure.alignment]
method = "given"
[procedure.navigation]
duration = "{seconds} s"
rotation = "none"
[record]
samples = "full"
[source]
uri = "replay:{file}"
[source.mcap]
topic = "{topic}"
time_field = "header.stamp.sec"
nanoseconds_field = "header.stamp.{nanoseconds}"
time_unit = "s"
[source.mcap.gyro]
x = "angular_velocity.x"
y = "angular_velocity.y"
z = "angular_velocity.z"
[source.mcap.accelerometer]
{accelerometer}x = "linear_acceleration.x"
y = "linear_acceleration.y"
z = "linear_acceleration.z"
"""


def idl(name, body):
    """A definition in IDL as rosidl_adapter lays it out."""
    package, _, kind = name.split("/")
    return f"""{'=' * 80}
IDL: {name}
// generated from rosidl_adapter/resource/msg.idl.em
module {package} {{
  module msg {{
{body.format(kind=kind)}
  }};
}};
"""


def imu_idl():
    vector = "    struct {kind} {{\n      double x;\n      double y;\n      double z;\n    }};"
    covariance = "      double__9 {}_covariance;"
    own = "\n".join(
        [
            "    typedef double double__9[9];",
            '    @verbatim (language="comment", text=\n      "Accelerations in m/s^2 (not in g)" "\\n"\n      "and rates in rad/s")',
            "    struct {kind} {{",
            "      std_msgs::msg::Header header;",
            "      geometry_msgs::msg::Quaternion orientation;",
            covariance.format("orientation"),
            "      geometry_msgs::msg::Vector3 angular_velocity;",
            covariance.format("angular_velocity"),
            "      geometry_msgs::msg::Vector3 linear_acceleration;",
            covariance.format("linear_acceleration"),
            "    }};",
        ]
    )
    quaternion = vector.replace("double z;", "double z;\n      double w;")
    header = "    struct {kind} {{\n      builtin_interfaces::msg::Time stamp;\n      string frame_id;\n    }};"
    time = "    struct {kind} {{\n      int32 sec;\n      uint32 nanosec;\n    }};"
    return "".join(
        [
            idl("sensor_msgs/msg/Imu", own),
            idl("geometry_msgs/msg/Quaternion", quaternion),
            idl("geometry_msgs/msg/Vector3", vector),
            idl("std_msgs/msg/Header", header),
            idl("builtin_interfaces/msg/Time", time),
        ]
    )


class Messages:
    """sensor_msgs/Imu with random numbers."""

    def __init__(self, version):
        self.version = version
        self.store = get_typestore(Stores.ROS1_NOETIC if version == 1 else Stores.ROS2_HUMBLE)
        draw = np.random.default_rng(44)
        self.gyro = draw.normal(0.0, 1e-3, (COUNT, 3))
        self.accel = draw.normal([0.0, 0.0, -9.8], 1e-2, (COUNT, 3))

    def definition(self):
        return self.store.generate_msgdef("sensor_msgs/msg/Imu", ros_version=self.version)[0]

    def stamp_ns(self, k):
        return START_NS + k * PERIOD_NS

    def message(self, k):
        types = self.store.types
        vector = lambda values: types["geometry_msgs/msg/Vector3"](*(float(value) for value in values))
        stamp = types["builtin_interfaces/msg/Time"](*divmod(self.stamp_ns(k), 10**9))
        # Names of several lengths shift what follows.
        fields = {"stamp": stamp, "frame_id": "imu_link"[: k % 9]}
        if self.version == 1:
            fields["seq"] = k
        return types["sensor_msgs/msg/Imu"](
            header=types["std_msgs/msg/Header"](**fields),
            orientation=types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0),
            orientation_covariance=np.arange(9.0),
            angular_velocity=vector(self.gyro[k]),
            angular_velocity_covariance=np.zeros(9),
            linear_acceleration=vector(self.accel[k]),
            linear_acceleration_covariance=np.zeros(9),
        )

    def bytes(self, k):
        serialize = self.store.serialize_ros1 if self.version == 1 else self.store.serialize_cdr
        return bytes(serialize(self.message(k), "sensor_msgs/msg/Imu"))


def write(path, messages, encoding, schema_encoding, definition, channels):
    """Writes an MCAP file: topics with the numbers of their messages."""
    with open(path, "wb") as file:
        writer = Writer(file)
        writer.start(profile=f"ros{messages.version}")
        name = "sensor_msgs/Imu" if messages.version == 1 else "sensor_msgs/msg/Imu"
        schema = writer.register_schema(name, schema_encoding, definition.encode())
        for topic, numbers in channels.items():
            channel = writer.register_channel(topic, encoding, schema)
            for k in numbers:
                stamp = messages.stamp_ns(k)
                writer.add_message(channel, stamp, messages.bytes(k), stamp)
        writer.finish()


def run(octant, folder, file, topic, nanoseconds, accelerometer="", seconds=COUNT / 100):
    """Samples that Octant makes of a file, or what it says where it refuses it."""
    scenario = folder / "foreign.toml"
    text = {"file": file, "topic": topic, "nanoseconds": nanoseconds, "accelerometer": accelerometer}
    scenario.write_text(TOML.format(seconds=seconds, **text))
    out = folder / "run"
    done = subprocess.run([octant, "run", scenario, "--out", out, "--force"], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        return None, done.stderr
    samples = {"delta_theta": [], "delta_velocity": []}
    with open(out / "recording.mcap", "rb") as recording:
        reader = make_reader(recording, decoder_factories=[DecoderFactory()])
        for _, _, _, message in reader.iter_decoded_messages(topics=["/imu"]):
            for name, values in samples.items():
                values.append(list(getattr(message, name)))
    return {name: np.array(values, float) * LSB[name] for name, values in samples.items()}, done.stdout + done.stderr


def compare(name, samples, messages, numbers):
    for quantity, rates in (("delta_theta", messages.gyro), ("delta_velocity", messages.accel)):
        wanted = np.cumsum(rates[numbers] * 0.01, axis=0)
        found = np.cumsum(samples[quantity], axis=0)
        assert found.shape == wanted.shape, f"{name}: {found.shape} samples, {wanted.shape} written"
        # What rounding leaves of a count is carried.
        worst = np.abs(found - wanted).max() / LSB[quantity]
        assert worst <= 1.0, f"{name}: {quantity} is {worst} counts off"
    print(f"{name}: {len(numbers)} samples as written")


def main():
    octant, folder = sys.argv[1], Path(sys.argv[2])
    one, two = Messages(1), Messages(2)
    every = np.arange(COUNT)

    path = folder / "ros1.mcap"
    write(path, one, "ros1", "ros1msg", one.definition(), {"/imu": every})
    samples, said = run(octant, folder, path, "/imu", "nsec")
    assert samples, said
    compare("ros1msg", samples, one, every)

    path = folder / "idl.mcap"
    write(path, two, "cdr", "ros2idl", imu_idl(), {"/imu": every})
    # Another reader takes the definition for one too, and has the same numbers.
    with AnyReader([path]) as bag:
        read = [bag.deserialize(data, c.msgtype).angular_velocity.y for c, _, data in bag.messages()]
    assert np.array_equal(read, two.gyro[:, 1])
    samples, said = run(octant, folder, path, "/imu", "nanosec")
    assert samples, said
    compare("ros2idl", samples, two, every)

    path = folder / "two.mcap"
    gyro, accel = every[5:], every[(every != 400) & (every < 990)]
    write(path, two, "cdr", "ros2msg", two.definition(), {"/gyro": gyro, "/accel": accel})
    samples, said = run(octant, folder, path, "/gyro", "nanosec", 'topic = "/accel"\n', seconds=9.8)
    assert samples, said
    both = np.intersect1d(gyro, accel)[: len(samples["delta_theta"])]
    assert len(both) >= 979, len(both)
    compare("two topics", samples, two, both)
    for expected in ("5 messages on /accel without one of the same stamp on /gyro", "messages on /gyro without one"):
        assert expected in said, said

    bag = folder / "ros1.bag"
    with BagWriter(bag) as writer:
        connection = writer.add_connection("/imu", "sensor_msgs/msg/Imu", typestore=one.store)
        for k in every:
            writer.write(connection, one.stamp_ns(k), one.bytes(k))
    samples, said = run(octant, folder, bag, "/imu", "nanosec")
    assert samples is None and "found a bag of ROS 1, expected MCAP: write `mcap convert" in said, said
    convert = Path(sys.executable).parent / "rosbags-convert"
    subprocess.run([convert, "--src", bag, "--dst", folder / "ros2", "--dst-storage", "mcap"], check=True)
    [path] = (folder / "ros2").glob("*.mcap")
    samples, said = run(octant, folder, path, "/imu", "nanosec")
    assert samples, said
    compare("a bag of ROS 1, converted", samples, one, every)


if __name__ == "__main__":
    main()
