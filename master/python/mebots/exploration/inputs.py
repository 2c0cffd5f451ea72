# SPDX-License-Identifier: Apache-2.0
"""Computes hashes of files and folders that missions name. Only folders of deployed networks count."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import pathlib
import re
import shutil
import threading

Content = bytes | dict[str, bytes]
"""The content of a file, or of the files of a folder by their relative paths."""


def is_input(name: str, path: str | os.PathLike[str]) -> bool:
    """True if a value names a file or the folder of a deployed network. ``name`` is the parameter, a JSON pointer of the config, or a
    pattern. Other values may equal the name of a folder by chance."""
    if not os.fspath(path):
        return False
    may_be_network = re.split(r"[./]", name)[-1] == "network" or "*" in name or "?" in name
    return os.path.isfile(path) or (may_be_network and os.path.isfile(os.path.join(path, "network.json")))


def digest_of_file(path: str | os.PathLike[str]) -> str:
    with open(path, "rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def digest_of_input(path: str | os.PathLike[str]) -> str:
    """Returns the hash of a file. For a folder, returns the hash of the paths and hashes of its files."""
    if not os.path.isdir(path):
        return digest_of_file(path)
    listed = [[name, digest_of_file(os.path.join(path, name))] for name in _files(path)]
    return hashlib.sha256(json.dumps(listed).encode()).hexdigest()


def content_of(path: str | os.PathLike[str]) -> Content:
    if not os.path.isdir(path):
        return pathlib.Path(path).read_bytes()
    return {name: pathlib.Path(path, name).read_bytes() for name in _files(path)}


def write_content(path: pathlib.Path, content: Content) -> None:
    """Writes a file or folder, which appears only when it is complete. Other processes may write the same content."""
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f"{path.name}.{os.getpid()}.{threading.get_ident()}")
    if isinstance(content, bytes):
        unfinished.write_bytes(content)
        unfinished.replace(path)
        return
    for name, part in content.items():
        (unfinished / name).parent.mkdir(parents=True, exist_ok=True)
        (unfinished / name).write_bytes(part)
    try:
        unfinished.rename(path)
    except OSError:  # damaged, or just written by another process
        old = unfinished.with_name(f"{unfinished.name}.old")
        with contextlib.suppress(OSError):
            path.rename(old)
            unfinished.rename(path)
        shutil.rmtree(old, ignore_errors=True)
        shutil.rmtree(unfinished, ignore_errors=True)


def stamp_of(path: str | os.PathLike[str]) -> tuple[tuple[str, int, int], ...]:
    """Returns names, times and sizes of files, which change if a file is written. Raises OSError."""
    names = _files(path) if os.path.isdir(path) else [""]
    stats = [(name, os.stat(os.path.join(path, name) if name else path)) for name in names]
    return tuple((name, one.st_mtime_ns, one.st_size) for name, one in stats)


def _files(folder: str | os.PathLike[str]) -> list[str]:
    return sorted(one.relative_to(folder).as_posix() for one in pathlib.Path(folder).rglob("*") if one.is_file())
