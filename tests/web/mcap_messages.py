# SPDX-License-Identifier: Apache-2.0
"""Reads MCAP files with MCAP's own package."""

import collections
import json

from mcap.reader import make_reader


def messages_of(file):
    """Returns the messages of each topic, each as (name of the schema, time [ns], content)."""
    messages = collections.defaultdict(list)
    with open(file, "rb") as stream:
        for schema, channel, message in make_reader(stream, validate_crcs=True).iter_messages():
            assert schema.encoding == "jsonschema" and channel.message_encoding == "json", channel.topic
            json.loads(schema.data)
            messages[channel.topic].append((schema.name, message.log_time, json.loads(message.data)))
    return messages
