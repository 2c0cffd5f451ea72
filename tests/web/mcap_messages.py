# SPDX-License-Identifier: Apache-2.0
"""Exports runs as MCAP files, and reads them with MCAP's own package."""

import collections
import json
import os
import subprocess
import sys

from mcap.reader import make_reader


def exported(mebots, run, file):
    """Exports the run in a folder as the MCAP file `file`. Returns its messages as messages_of() does."""
    command = [mebots, "report", run, "--out", file + ".html", "--mcap", file]
    subprocess.run(command, check=True, env=os.environ | {"MEBOTS_PYTHON": sys.executable})
    return messages_of(file)


def messages_of(file):
    """Returns the messages of each topic, each as (name of the schema, time [ns], content)."""
    messages = collections.defaultdict(list)
    with open(file, "rb") as stream:
        for schema, channel, message in make_reader(stream, validate_crcs=True).iter_messages():
            assert schema.encoding == "jsonschema" and channel.message_encoding == "json", channel.topic
            json.loads(schema.data)
            messages[channel.topic].append((schema.name, message.log_time, json.loads(message.data)))
    return messages
