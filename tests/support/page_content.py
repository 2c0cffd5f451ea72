# SPDX-License-Identifier: Apache-2.0
"""Reads the JSON in a page of a study or of a replayed flight."""

import base64
import json
import pathlib
import re
import unittest
import zlib


def page_content(page):
    """Returns the content of a page. `page` is a file or its text. In a build without pages, skips the test."""
    text = page.read_text(encoding="utf-8") if isinstance(page, pathlib.Path) else page
    packed = re.search(r'id="mebots-data" type="application/octet-stream">([^<]*)<', text)
    if packed is None and "MEBOTS_PAGES=OFF" in text:
        raise unittest.SkipTest("MEBOTS_PAGES is OFF: the page has the answer as text only")
    return json.loads(zlib.decompress(base64.b64decode(packed.group(1))))
