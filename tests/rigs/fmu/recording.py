"""What a full-rate recording of octant has, as columns of the FMUs' variables.

Byte layouts: docs/recording.md. Messages are of fixed size, so that numpy reads them as they are.
"""

import numpy as np
from mcap.reader import make_reader

IMU = np.dtype([
    ("sequence", "<u8"), ("device_time_ns", "<u8"), ("delta_theta", "<i4", 3),
    ("delta_velocity", "<i4", 3), ("azimuth", "<i4"), ("roll", "<i4"), ("status", "<u2"),
])
AIDING = np.dtype([("device_time_ns", "<u8"), ("value", "<f8", 3), ("kind", "u1")])
OUTPUT = np.dtype([
    ("sequence", "<u8"), ("device_time_ns", "<u8"), ("latitude", "<f8"), ("longitude", "<f8"),
    ("height", "<f8"), ("velocity", "<f8", 3), ("q_nb", "<f8", 4), ("nis", "<f8"),
    ("azimuth", "<i4"), ("roll", "<i4"), ("health", "<u4"), ("revision", "<u4"), ("stop", "<u2"),
    ("mode", "u1"), ("moving", "u1"),
])
PARAMETERS = np.dtype([("sequence", "<u8"), ("values", "<f8", 30), ("sigma", "<f8", 30),
                       ("revision", "<u4")])
TOPICS = {"/imu": IMU, "/aiding": AIDING, "/output": OUTPUT, "/parameters": PARAMETERS}

# Groups of the error parameters in their order.
GROUPS = [("gyro_bias", 3), ("gyro_scale", 3), ("gyro_misalignment", 6), ("g_dependent", 9),
          ("accel_bias", 3), ("accel_scale", 3), ("accel_misalignment", 3)]

DELTA_THETA, DELTA_VELOCITY, GIMBAL = 2.0**-36, 2.0**-30, 2.0**-27


def read(path):
    """The messages of each topic, as one array."""
    bodies = {topic: [] for topic in TOPICS}
    with open(path, "rb") as file:
        for _, channel, message in make_reader(file).iter_messages(topics=list(TOPICS)):
            bodies[channel.topic].append(message.data[4:])
    return {topic: np.frombuffer(b"".join(parts), dtype=TOPICS[topic])
            for topic, parts in bodies.items()}


def inputs(messages):
    """The calibrator's inputs before each step: name to an array with a row for each."""
    imu, aiding = messages["/imu"], messages["/aiding"]
    at = np.searchsorted(imu["device_time_ns"], aiding["device_time_ns"])
    assert (imu["device_time_ns"][at] == aiding["device_time_ns"]).all(), "aiding of no sample"
    kind = np.zeros(len(imu), dtype=np.int32)
    kind[at] = aiding["kind"].astype(np.int32) + 1
    value = np.zeros((len(imu), 3))
    value[at] = aiding["value"]
    velocity = np.where(kind[:, None] == 1, value, 0.0)
    position = np.where(kind[:, None] == 2, value, 0.0)
    return {
        "gyro.delta_theta": imu["delta_theta"] * DELTA_THETA,
        "accelerometer.delta_velocity": imu["delta_velocity"] * DELTA_VELOCITY,
        "gimbal.azimuth": imu["azimuth"] * GIMBAL,
        "gimbal.roll": imu["roll"] * GIMBAL,
        "imu.valid": np.ones(len(imu), dtype=bool),
        "imu.status": imu["status"].astype(np.int32),
        "imu.sequence": imu["sequence"],
        "imu.device_time_ns": imu["device_time_ns"],
        "reference.kind": kind,
        "reference.velocity": velocity,
        "reference.latitude": position[:, 0],
        "reference.longitude": position[:, 1],
        "reference.height": position[:, 2],
        "reference.age_ns": np.zeros(len(imu)),
    }


def outputs(messages):
    """The calibrator's outputs after each step."""
    output, parameters = messages["/output"], messages["/parameters"]
    measured = ~np.isnan(output["nis"])
    columns = {
        "gimbal_command.azimuth": output["azimuth"] * GIMBAL,
        "gimbal_command.roll": output["roll"] * GIMBAL,
        "mode": output["mode"].astype(np.int32),
        "stop": output["stop"].astype(np.int32),
        "moving": output["moving"].astype(bool),
        "navigation.latitude": output["latitude"],
        "navigation.longitude": output["longitude"],
        "navigation.height": output["height"],
        "navigation.velocity": output["velocity"],
        "navigation.attitude": output["q_nb"],
        "filter.nis": np.where(measured, output["nis"], 0.0),
        "filter.measured": measured,
        "health": output["health"].astype(np.int32),
        "answer.sequence": output["sequence"],
        "answer.device_time_ns": output["device_time_ns"],
        "parameters.revision": output["revision"].astype(np.uint64),
    }
    # Parameters stand in the file when they change; between, they hold.
    last = np.searchsorted(parameters["sequence"], output["sequence"], side="right") - 1
    known = last >= 0
    for prefix, field in (("parameters", "values"), ("sigma", "sigma")):
        at = 0
        for group, count in GROUPS:
            columns[f"{prefix}.{group}"] = parameters[field][last][:, at:at + count]
            at += count
    return columns, known
