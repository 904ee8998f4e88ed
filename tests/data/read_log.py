"""Reads a log of Wisdom with packages from PyPI alone and prints what it found as one JSON object.

    pip install mcap mcap-protobuf-support blake3
    python read_log.py LOG.mcap

Numbers that must agree to the last bit are printed as their bytes in hexadecimal. A file without its end is read
from the front, as far as it goes.
"""

import json
import struct
import sys

import blake3
import zstandard
from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader, make_reader
from mcap_protobuf.decoder import DecoderFactory

CHAIN_TAG = 13
# What a damaged file raises: the reader's own errors, a bad checksum, a chunk that does not decompress.
DAMAGE = (McapError, ValueError, zstandard.ZstdError)


def digest(data):
    return blake3.blake3(data).hexdigest()


def f64(number):
    return struct.pack("<d", number).hex()


def floats(numbers):
    return struct.pack(f"<{len(numbers)}f", *numbers)


def varint(data, at):
    number, shift = 0, 0
    while True:
        byte = data[at]
        at += 1
        number |= (byte & 0x7F) << shift
        if byte < 0x80:
            return number, at
        shift += 7


def without_chain(data):
    """The bytes of a decision up to its last field, which is the chain."""
    at = 0
    while at < len(data):
        start = at
        key, at = varint(data, at)
        if key >> 3 == CHAIN_TAG:
            return data[:start]
        kind = key & 7
        if kind == 0:
            _, at = varint(data, at)
        elif kind == 1:
            at += 8
        elif kind == 2:
            length, at = varint(data, at)
            at += length
        elif kind == 5:
            at += 4
        else:
            raise ValueError(f"wire type {kind} at byte {start}")
    return data


def decision(message, chain):
    choice = message.choice
    stops = message.objective.family[choice.chosen].sequence.stops
    return {
        "number": message.number,
        "version": message.decision_version,
        "act": choice.act.name,
        "goal": choice.act.goal if choice.act.HasField("goal") else None,
        "stops": [stop.goal for stop in stops],
        "prizes": [[v.goal.id, f64(v.goal.prize)] for v in choice.verdicts],
        "reasons": [v.reason for v in choice.verdicts],
        "triggers": [trigger.name for trigger in message.triggers],
        "chain": message.chain,
        "chain_again": chain.hex(),
    }


def observation(message):
    windows = [
        {
            "layer": w.layer,
            "place": [w.row, w.col, w.rows, w.cols],
            "values": digest(floats(w.values)),
            "uncertainty": digest(floats(w.uncertainty)),
        }
        for w in message.windows
    ]
    cell = message.pose.cell
    return {
        "number": message.number,
        "cell": [cell.row, cell.col],
        "time_s": f64(message.spent.time_s),
        "windows": windows,
    }


def grid(topic, sequence, message):
    """A map with its rows turned round: row 0 in the north."""
    (field,) = message.fields
    assert (field.name, field.offset, field.type) == ("value", 0, 7), field
    cols, stride = message.column_count, message.row_stride
    rows = len(message.data) // stride
    north_first = []
    for row in reversed(range(rows)):
        north_first.append(struct.unpack_from(f"<{cols}f", message.data, row * stride))
    corners = [north_first[0][0], north_first[0][-1], north_first[-1][0], north_first[-1][-1]]
    return {
        "topic": topic,
        "decision": sequence,
        "rows": rows,
        "cols": cols,
        "cell_m": message.cell_size.x,
        "corners": [floats([corner]).hex() for corner in corners],
        "digest": digest(b"".join(floats(row) for row in north_first)),
    }


def cloud(sequence, message):
    assert [f.name for f in message.fields] == ["x", "y", "z", "interest"]
    points = struct.iter_unpack("<4f", message.data)
    return {"decision": sequence, "points": [list(point) for point in points]}


def main(path):
    found = {
        "topics": {},
        "decisions": [],
        "observations": [],
        "grids": [],
        "clouds": [],
        "attachments": [],
        "error": None,
    }
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        try:
            summary = reader.get_summary()
            found["metadata"] = {m.name: m.metadata for m in reader.iter_metadata()}
            for a in reader.iter_attachments():
                found["attachments"].append([a.name, a.media_type, digest(a.data)])
            counts = summary.statistics.channel_message_counts
            found["statistics"] = {c.topic: counts[c.id] for c in summary.channels.values()}
        except DAMAGE as error:
            found["error"] = type(error).__name__
            file.seek(0)
            reader = NonSeekingReader(file, validate_crcs=True)
        factory = DecoderFactory()
        chain = bytes(32)
        last_time = -1
        try:
            for schema, channel, message in reader.iter_messages(log_time_order=False):
                assert message.log_time > last_time, "no two messages share a time"
                last_time = message.log_time
                topic = channel.topic
                found["topics"][topic] = found["topics"].get(topic, 0) + 1
                decoded = factory.decoder_for(channel.message_encoding, schema)(message.data)
                if topic == "/decision":
                    chain = blake3.blake3(chain + without_chain(message.data)).digest()
                    found["decisions"].append(decision(decoded, chain))
                elif topic == "/in/observation":
                    found["observations"].append(observation(decoded))
                elif topic.startswith("/map/"):
                    found["grids"].append(grid(topic, message.sequence, decoded))
                elif topic == "/terrain/interest":
                    found["clouds"].append(cloud(message.sequence, decoded))
        except DAMAGE as error:
            found["error"] = type(error).__name__
    json.dump(found, sys.stdout)


main(sys.argv[1])
