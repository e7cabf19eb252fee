"""A client of Foxglove's WebSocket protocol, written from the protocol's description, against octant.

Usage: watch_client.py OCTANT
"""

import json
import pathlib
import re
import signal
import struct
import subprocess
import sys
import tempfile

import websockets.exceptions
from websockets.sync.client import connect

from children import popen

OCTANT = sys.argv[1]
FIXTURES = pathlib.Path(__file__).resolve().parents[2] / "fixtures"
STANDARD = {"/imu/data", "/fix", "/error/position", "/error/velocity", "/error/attitude"}
TOPICS = STANDARD | {f"/octant/{name}" for name in "state error parameters gimbals nis pacing faults".split()}
# Waiting for longer than this is a failure, not a slow host.
PATIENCE_S = 600

BY_THE_CLOCK = """
schema = 1
title = "served"
[procedure.alignment]
method = "given"
[procedure.navigation]
duration = "12 s"
[realtime]
overrun = "100 s"
[[faults]]
id = "spike-1"
kind = "spike"
channels = "gyro x"
amplitude = "1000 deg/h"
trigger = { at = "3 s" }
duration = "20 samples"
"""


def ends(*arguments):
    """The program to its end, which has to be a good one."""
    ended = subprocess.run([OCTANT, *map(str, arguments)], capture_output=True, text=True, timeout=PATIENCE_S)
    assert ended.returncode == 0, f"{arguments}: status {ended.returncode}: {ended.stdout}{ended.stderr}"


def start(*arguments):
    """The program, and the address that it says it serves."""
    process = popen(
        [OCTANT, *map(str, arguments)], stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    said = []
    for line in process.stderr:
        if found := re.search(r"ws://\S+", line):
            return process, found.group()
        said.append(line)
    raise AssertionError(f"{arguments}: ended without serving, status {process.wait()}: {''.join(said)}")


class Client:
    """Connected, with every channel subscribed."""

    def __init__(self, address):
        self.socket = connect(address, subprotocols=["foxglove.sdk.v1"], open_timeout=PATIENCE_S)
        assert self.socket.subprotocol == "foxglove.sdk.v1", self.socket.subprotocol
        self.channels = {}
        self.times = []
        self.messages = {}
        self.server = None
        while self.server is None or not self.channels:
            self.text(json.loads(self.socket.recv(PATIENCE_S)))
        assert self.server["name"] == "octant" and "time" in self.server["capabilities"], self.server
        assert {channel["topic"] for channel in self.channels.values()} == TOPICS, self.channels
        subscriptions = [{"id": id + 100, "channelId": id} for id in self.channels]
        self.socket.send(json.dumps({"op": "subscribe", "subscriptions": subscriptions}))

    def text(self, message):
        if message["op"] == "serverInfo":
            self.server = message
        elif message["op"] == "advertise":
            for channel in message["channels"]:
                wanted = ("cdr", "ros2msg") if channel["topic"] in STANDARD else ("json", "jsonschema")
                assert (channel["encoding"], channel["schemaEncoding"]) == wanted, channel
                self.channels[channel["id"]] = channel

    def take(self):
        """One message; False once the server has gone."""
        try:
            message = self.socket.recv(PATIENCE_S)
        except websockets.exceptions.ConnectionClosed:
            return False
        if isinstance(message, str):
            self.text(json.loads(message))
        elif message[0] == 1:
            subscription, time_ns = struct.unpack_from("<IQ", message, 1)
            channel = self.channels[subscription - 100]
            if channel["topic"] in STANDARD:
                content = message[13:]
                # Little-endian CDR; the stamp is the time of the message.
                head = struct.unpack_from("<BBHiI", content)
                assert head[:2] == (0, 1) and head[3] * 10**9 + head[4] == time_ns, (channel["topic"], head, time_ns)
            else:
                content = json.loads(message[13:])
                check(content, json.loads(channel["schema"]), channel["topic"])
            self.messages.setdefault(channel["topic"], []).append((time_ns, content))
        elif message[0] == 2:
            self.times.append(struct.unpack_from("<Q", message, 1)[0])
        return True

    def until(self, satisfied):
        while not satisfied(self):
            assert self.take(), f"the server went: {sorted(self.messages)}"
        return self

    def last(self, topic):
        return self.messages.get(topic, [(0, {})])[-1]


def check(content, schema, place):
    """Every value has a schema and is what it says; null where a number isn't known."""
    kind = schema["type"]
    if kind == "object":
        assert isinstance(content, dict), (place, content)
        for name, value in content.items():
            assert name in schema["properties"], f"{place}.{name} has no schema"
            check(value, schema["properties"][name], f"{place}.{name}")
    elif kind == "array":
        for value in content:
            check(value, schema["items"], f"{place}[]")
    elif content is not None:
        types = {"number": (int, float), "string": str, "boolean": bool}[kind]
        assert isinstance(content, types), f"{place} is {content!r}, expected a {kind}"


def hash_of(folder):
    return json.loads((folder / "summary.json").read_text())["stream_hash"]


def live(here):
    """A run by the clock, with clients that come and go."""
    scenario = here / "served.toml"
    scenario.write_text(BY_THE_CLOCK)
    alone = here / "alone"
    ends("run", scenario, "--out", alone)

    run, address = start("run", scenario, "--out", here / "run", "--realtime", "--live=127.0.0.1:0")
    stays = Client(address)
    leaves = Client(address).until(lambda client: "/octant/state" in client.messages)
    leaves.socket.close()
    stays.until(lambda client: client.last("/octant/pacing")[1].get("samples", 0) >= 400)
    # What was before comes with the subscription.
    late = Client(address).until(lambda client: len(client.messages.get("/octant/state", [])) > 2)
    assert late.messages["/octant/state"][0][0] <= 1_000_000_000, late.messages["/octant/state"][0]
    while stays.take():
        pass
    assert run.wait(PATIENCE_S) == 0, run.stderr.read()
    assert hash_of(here / "run") == hash_of(alone), "being watched changed the run"

    states = stays.messages["/octant/state"]
    assert states[-1][0] >= 5_000_000_000 and states[-1][1]["mode"] in ("navigating", "done"), states[-1]
    assert states[-1][1]["done_percent"] > 80, states[-1]
    paces = [pace["samples"] for _, pace in stays.messages["/octant/pacing"]]
    assert paces[-1] == 2400, paces
    assert stays.last("/octant/faults")[1]["fired"] == 1, stays.last("/octant/faults")
    assert stays.messages["/octant/faults"][0][1]["fired"] == 0, "armed before it fired"
    assert "radial_nmi" in stays.last("/octant/error")[1]
    assert "azimuth_deg" in stays.last("/octant/gimbals")[1]
    assert STANDARD <= set(stays.messages), sorted(stays.messages)
    assert stays.messages["/fix"][-1][0] >= 5_000_000_000, stays.messages["/fix"][-1][0]
    assert stays.times == sorted(stays.times) and stays.times, "the server's clock is run time"
    print(f"live: {sum(map(len, stays.messages.values()))} messages of {len(stays.messages)} topics")


def recorded(here):
    """A run that has ended, with its calibration."""
    out = here / "recorded"
    scenario = FIXTURES / "scenarios" / "lockstep.toml"
    ends("run", scenario, "--out", out)
    process, address = start("watch", out, "--foxglove=127.0.0.1:0")
    client = Client(address)
    client.until(lambda client: client.messages.get("/octant/parameters") and "/octant/nis" in client.messages)
    parameters = client.last("/octant/parameters")[1]
    assert len(parameters) == 30 and parameters["gyro_bias_x"]["sigma"] > 0, parameters
    process.send_signal(signal.SIGINT)
    while client.take():
        pass
    assert process.wait(PATIENCE_S) == 0, process.stderr.read()
    print(f"recorded: {sum(map(len, client.messages.values()))} messages of {len(client.messages)} topics")


def refused(here):
    """An address that is taken is told before anything is written."""
    process, address = start("watch", here / "recorded", "--foxglove=127.0.0.1:0")
    port = address.rsplit(":", 1)[1]
    again = subprocess.run(
        [OCTANT, "run", here / "served.toml", "--out", here / "no", f"--live=127.0.0.1:{port}"],
        capture_output=True, text=True, timeout=PATIENCE_S,
    )
    assert again.returncode == 4 and "failed to serve at" in again.stderr, again
    assert not (here / "no").exists() and not (here / "no.partial").exists()
    process.send_signal(signal.SIGINT)
    assert process.wait(PATIENCE_S) == 0
    print("a port that is taken: told before anything is written")


with tempfile.TemporaryDirectory() as folder:
    live(pathlib.Path(folder))
    recorded(pathlib.Path(folder))
    refused(pathlib.Path(folder))
