#!/usr/bin/env python3
"""Reads exports of a recording with the readers of others, and checks them against the recording itself.

Usage: python tests/rigs/export_reader.py RECORDING FOLDER

FOLDER holds csv/, parquet/, mat, kml and rosbag-mcap.mcap of `octant export`. Needs the packages of
tests/rigs/requirements-export.txt. Exit status: 0 as expected, 1 with the assertion that doesn't hold.
"""

import collections
import csv
import json
import math
import sys
from pathlib import Path

import numpy
import pyarrow.parquet
import scipy.io
from lxml import etree
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.interfaces import MessageDefinitionFormat
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

LSB = {"delta_theta": 2.0**-36, "delta_velocity": 2.0**-30}


def recorded(path):
    """Messages of the recording by topic, with their times in s."""
    topics = collections.defaultdict(list)
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, channel, message, decoded in reader.iter_decoded_messages(
            topics=["/imu", "/output", "/truth", "/parameters"]
        ):
            topics[channel.topic].append((message.log_time * 1e-9, decoded))
    return topics


def near(found, wanted, what):
    found, wanted = numpy.asarray(found, float), numpy.asarray(wanted, float)
    assert found.shape == wanted.shape, f"{what}: {found.shape} rows, recorded {wanted.shape}"
    scale = max(1.0, float(numpy.nanmax(numpy.abs(wanted), initial=0.0)))
    worst = float(numpy.nanmax(numpy.abs(found - wanted), initial=0.0))
    assert worst <= 4e-15 * scale, f"{what}: {worst} beside {scale}"
    assert (numpy.isnan(found) == numpy.isnan(wanted)).all(), f"{what}: empty cells"


def check_tables(topics, tables, name):
    """Columns by table and name, as arrays with NaN, against the recording."""
    samples, navigation, parameters = (tables[t] for t in ("samples", "navigation", "parameters"))
    near(samples["time_s"], [t for t, _ in topics["/imu"]], f"{name}: times")
    for quantity, suffix in (("delta_theta", "rad"), ("delta_velocity", "mps")):
        for i, axis in enumerate("xyz"):
            wanted = [getattr(m, quantity)[i] * LSB[quantity] for _, m in topics["/imu"]]
            near(samples[f"{quantity}_{axis}_{suffix}"], wanted, f"{name}: {quantity} {axis}")
    outputs = [m for _, m in topics["/output"]]
    near(navigation["latitude_deg"], [math.degrees(m.latitude_rad) for m in outputs], f"{name}: latitude")
    near(navigation["velocity_down_mps"], [m.velocity_mps[2] for m in outputs], f"{name}: velocity")
    near(navigation["mode"], [m.mode for m in outputs], f"{name}: mode")
    near(navigation["nis"], [m.nis for m in outputs], f"{name}: NIS")
    truth = {t: m for t, m in topics["/truth"]}
    nan = float("nan")
    errors = [
        (m.latitude_rad - truth[t].latitude_rad) * 180 * 60 / math.pi if t in truth and m.mode in (1, 3, 4) else nan
        for t, m in topics["/output"]
    ]
    near(navigation["latitude_error_arcmin"], errors, f"{name}: latitude error")
    per_unit = math.pi / 180 / 3600
    near(parameters["gyro_bias_z_dph"], [m.gyro_bias_z / per_unit for _, m in topics["/parameters"]], f"{name}: bias")
    sigma = [m.sigma_gyro_bias_z / per_unit for _, m in topics["/parameters"]]
    near(parameters["sigma_gyro_bias_z_dph"], sigma, f"{name}: sigma")
    assert "error_gyro_bias_z_dph" in parameters, name
    print(f"{name}: {len(samples['time_s'])} samples, {len(outputs)} outputs as recorded")


def floats(values):
    return numpy.array([math.nan if v in ("", None) else float(v) for v in values])


def read_csv(folder):
    tables = {}
    about = json.loads((folder / "export.json").read_text())
    assert about["version"] == 1
    for table in about["tables"]:
        with open(folder / f"{table['table']}.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        assert len(rows) == table["rows"], table["table"]
        numbers = [c["name"] for c in table["columns"] if c["kind"] in ("number", "integer")]
        tables[table["table"]] = {name: floats(row[name] for row in rows) for name in numbers}
    return tables


def read_parquet(folder):
    tables = {}
    for path in folder.glob("*.parquet"):
        table = pyarrow.parquet.read_table(path)
        assert pyarrow.parquet.read_metadata(path).metadata[b"octant.export"] == b"1"
        for field in table.schema:
            assert field.metadata[b"description"], field.name
            if field.name.endswith("_deg"):
                assert field.metadata[b"unit"] == b"deg", field
        numbers = [f.name for f in table.schema if f.type in (pyarrow.float64(), pyarrow.int64())]
        tables[path.stem] = {name: floats(table[name].to_pylist()) for name in numbers}
    assert pyarrow.parquet.read_schema(folder / "navigation.parquet").field("moving").type == pyarrow.bool_()
    return tables


def read_mat(path):
    # scipy adds the end .mat to a name without it only where the file isn't there.
    content = scipy.io.loadmat(path, squeeze_me=True, struct_as_record=False, appendmat=False)
    assert content["octant_export"].version == 1
    assert json.loads(content["octant_export"].about)["version"] == 1
    assert content["units"].navigation.latitude_deg == "deg"
    assert content["navigation"].moving.dtype in (numpy.bool_, numpy.uint8)
    events = content["events"]
    assert set(events.kind) >= {"mode"}, events.kind
    assert all(json.loads(text) is not None for text in events.detail)
    tables = {}
    for name in ("samples", "navigation", "parameters"):
        fields = content[name]._fieldnames
        tables[name] = {field: getattr(content[name], field) for field in fields}
    return tables


def check_kml(path, topics):
    spaces = {"k": "http://www.opengis.net/kml/2.2", "gx": "http://www.google.com/kml/ext/2.2"}
    tree = etree.parse(str(path))
    outputs = [m for _, m in topics["/output"] if m.mode in (1, 3, 4)]
    for name in ("truth", "navigation"):
        [mark] = tree.xpath(f"//k:Placemark[k:name='{name}']", namespaces=spaces)
        times = mark.xpath("gx:Track/k:when/text()", namespaces=spaces)
        points = mark.xpath("gx:Track/gx:coord/text()", namespaces=spaces)
        assert len(times) == len(points) > 0, name
        assert times == sorted(times) and times[0].startswith("1970-01-01T00:"), times[0]
        if name == "navigation":
            assert len(points) == len(outputs)
            longitude, latitude, _ = map(float, points[-1].split())
            assert abs(latitude - math.degrees(outputs[-1].latitude_rad)) < 1e-9
            assert abs(longitude - math.degrees(outputs[-1].longitude_rad)) < 1e-9
        print(f"kml: {name} with {len(points)} points")


def check_standard(name, store, types):
    """Definitions in the file of standard messages are those of ROS 2."""
    for part, (_, fields) in types.items():
        if not part.startswith("octant_msgs/"):
            standard = [(field, kind) for field, kind in store.fielddefs[part][1]]
            assert fields == standard, f"{name}, {part}: {fields}, the standard has {standard}"


def check_rosbag(path, topics):
    """Opens the file as a bag of ROS 2 with rosbags, which refuses every encoding but CDR."""
    standard = get_typestore(Stores.ROS2_HUMBLE)
    counts, last = collections.Counter(), {}
    messages = collections.defaultdict(list)
    with AnyReader([path]) as bag:
        for connection in bag.connections:
            assert connection.msgdef.format == MessageDefinitionFormat.MSG, connection
            assert connection.ext.serialization_format == "cdr", connection
            types = get_types_from_msg(connection.msgdef.data, connection.msgtype)
            check_standard(connection.topic, standard, types)
        for connection, time_ns, data in bag.messages():
            counts[connection.topic] += 1
            # Types of the file itself, so that messages of no package are read too.
            message = bag.deserialize(data, connection.msgtype)
            stamp = message.header.stamp
            assert stamp.sec * 10**9 + stamp.nanosec == time_ns, connection.topic
            if connection.msgtype in standard.fielddefs:
                again = standard.serialize_cdr(message, connection.msgtype)
                assert bytes(again) == bytes(data), f"{connection.topic}: {connection.msgtype}"
            messages[connection.topic].append(message)
            last[connection.topic] = message
    # Another reader of the same file.
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        decoded = collections.Counter(channel.topic for _, channel, _, _ in reader.iter_decoded_messages())
    assert decoded == counts, (decoded, counts)
    assert counts["/imu/data"] == len(topics["/imu"]), counts
    assert counts["/fix"] == counts["/octant/state"] == len(topics["/output"]), counts
    output, sample = topics["/output"][-1][1], topics["/imu"][-1][1]
    assert last["/fix"].latitude == math.degrees(output.latitude_rad)
    rate = 200.0
    turned = last["/imu/data"].angular_velocity
    near(
        [turned.x, turned.y, turned.z],
        [sample.delta_theta[i] * LSB["delta_theta"] * rate * sign for i, sign in enumerate((1, -1, -1))],
        "angular velocity",
    )
    q = last["/imu/data"].orientation
    assert abs(q.x**2 + q.y**2 + q.z**2 + q.w**2 - 1) < 1e-9
    for topic in ("/error/position", "/error/attitude", "/truth/fix", "/velocity"):
        assert counts[topic] > 0, topic
    check_own(messages, topics)
    print("rosbag-mcap:", ", ".join(f"{topic} {count}" for topic, count in sorted(counts.items())))
    return counts


def check_own(messages, topics):
    """Messages of octant_msgs, against the recording."""
    outputs = [m for _, m in topics["/output"]]
    states = messages["/octant/state"]
    near([m.time_s for m in states], [t for t, _ in topics["/output"]], "state: times")
    near([m.mode_number for m in states], [m.mode for m in outputs], "state: mode")
    near([m.stop for m in states], [m.stop + 1 for m in outputs], "state: stop")
    assert [m.moving for m in states] == [bool(m.moving) for m in outputs], "state: moving"
    names = {0: "aligning", 1: "calibrating", 2: "refused", 3: "navigating", 4: "done"}
    assert all(m.mode == names[m.mode_number] for m in states), "state: names"
    assert all(isinstance(m.health, list) and (not m.health_bits) == (not m.health) for m in states), "state: health"
    per_unit = math.pi / 180 / 3600
    near(
        [m.gyro_bias_z.value for m in messages["/octant/parameters"]],
        [m.gyro_bias_z / per_unit for _, m in topics["/parameters"]],
        "parameters",
    )
    sigma = [m.sigma_gyro_bias_z / per_unit for _, m in topics["/parameters"]]
    found = [m.gyro_bias_z.sigma for m in messages["/octant/parameters"]]
    near(found, [s if s > 0 else math.nan for s in sigma], "sigma")
    truth = {t: m for t, m in topics["/truth"]}
    errors = [
        (m.latitude_rad - truth[t].latitude_rad) * 180 * 60 / math.pi
        for t, m in topics["/output"]
        if t in truth and m.mode in (1, 3, 4)
    ]
    found = [m.latitude_arcmin for m in messages["/octant/error"]]
    assert len(errors) == len(found) > 100, (len(errors), len(found))
    assert max(abs(a - b) for a, b in zip(errors, found, strict=True)) < 1e-9
    armed = messages["/octant/faults"][0]
    assert (armed.armed, armed.fired, armed.acting, armed.faults) == (0, 0, 0, []), armed


def check_layouts(counts):
    """Every topic that a layout shows is in the file, but those that only a run with faults or a clock has."""
    root = Path(__file__).parent / "../../fixtures"
    plotted = etree.parse(str(root / "plotjuggler/octant-layout.xml")).xpath("//curve/@name")
    assert plotted
    for name in plotted:
        assert any(name.startswith(f"{topic}/") for topic in counts), f"PlotJuggler: {name} has no topic"
    print(f"PlotJuggler: {len(plotted)} curves")


def main():
    recording, folder = sys.argv[1], Path(sys.argv[2])
    topics = recorded(recording)
    check_tables(topics, read_csv(folder / "csv"), "csv")
    check_tables(topics, read_parquet(folder / "parquet"), "parquet")
    check_tables(topics, read_mat(folder / "mat"), "mat")
    check_kml(folder / "kml", topics)
    check_layouts(check_rosbag(folder / "rosbag-mcap.mcap", topics))


if __name__ == "__main__":
    main()
