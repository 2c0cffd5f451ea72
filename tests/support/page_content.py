# SPDX-License-Identifier: Apache-2.0
"""The JSON in a page of a study or of a replayed flight."""

import base64
import json
import pathlib
import re
import zlib


def page_content(page):
    """Returns the content of a page, which is a file or its text."""
    text = page.read_text(encoding="utf-8") if isinstance(page, pathlib.Path) else page
    packed = re.search(r'id="mebots-data" type="application/octet-stream">([^<]*)<', text).group(1)
    return json.loads(zlib.decompress(base64.b64decode(packed)))
