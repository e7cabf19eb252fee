#!/usr/bin/env python3
"""Reads an octant recording with the readers of others and prints what is in it.

Usage: python tests/rigs/mcap_reader.py RECORDING [--expect TOPIC=COUNT]...

Needs the packages of tests/rigs/requirements.txt. Every chunk's CRC is checked, every message is
decoded by its own schema. Exit status: 0 as expected, 1 not as expected, 2 not readable.
"""

import argparse
import collections
import json
import sys
import zlib

from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory


def attachment_crc_holds(attachment, path):
    """The reader library does not check the CRC of an attachment: find its bytes and do it."""
    with open(path, "rb") as file:
        content = file.read()
    at = content.find(attachment.data)
    start = content.rfind(b"\x09", 0, at)
    while start >= 0:
        length = int.from_bytes(content[start + 1 : start + 9], "little")
        end = start + 9 + length
        if at < end <= len(content) and at + len(attachment.data) + 4 == end:
            body, crc = content[start + 9 : end - 4], content[end - 4 : end]
            return zlib.crc32(body) == int.from_bytes(crc, "little")
        start = content.rfind(b"\x09", 0, start)
    return False


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recording")
    parser.add_argument("--expect", action="append", default=[], metavar="TOPIC=COUNT")
    arguments = parser.parse_args()

    counts = collections.Counter()
    last = {}
    try:
        # Once record by record, with CRCs of chunks and of the summary.
        with open(arguments.recording, "rb") as file:
            records = collections.Counter(
                type(record).__name__ for record in StreamReader(file, validate_crcs=True).records
            )
        # Once by the index, as a viewer does, decoding by the schemas in the file.
        with open(arguments.recording, "rb") as file:
            reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
            for schema, channel, message in reader.iter_messages():
                counts[channel.topic] += 1
                if channel.message_encoding == "json":
                    last[channel.topic] = json.loads(message.data)
            for schema, channel, message, decoded in reader.iter_decoded_messages(
                topics=[topic for topic in counts if topic not in last]
            ):
                last[channel.topic] = decoded
            metadata = {record.name: record.metadata for record in reader.iter_metadata()}
            attachments = list(reader.iter_attachments())
    except (McapError, ValueError, OSError) as error:
        print(f"failed to read {arguments.recording}: {error}", file=sys.stderr)
        return 2

    print("records:", dict(records))
    for name, values in metadata.items():
        print(f"metadata {name}: {values}")
    failed = False
    for attachment in attachments:
        holds = attachment_crc_holds(attachment, arguments.recording)
        failed |= not holds
        crc = "CRC holds" if holds else "CRC BROKEN"
        print(f"attachment {attachment.name}: {len(attachment.data)} bytes, {crc}")
    for topic, count in sorted(counts.items()):
        print(f"{topic}: {count}")
    for topic, decoded in sorted(last.items()):
        print(f"last on {topic}: {decoded}")
    for expected in arguments.expect:
        topic, _, count = expected.partition("=")
        if counts[topic] != int(count):
            print(f"{topic}: {counts[topic]} messages, expected {count}", file=sys.stderr)
            failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
