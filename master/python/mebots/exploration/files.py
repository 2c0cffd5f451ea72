# SPDX-License-Identifier: Apache-2.0
"""Writes files that are either complete or absent, even after errors of the disk."""

from __future__ import annotations

import contextlib
import os
import pathlib
import re
from collections.abc import Callable, Iterable, Iterator, Sequence

_BLOCK_BYTES = 1 << 20
_QUOTE = '"'
_SPECIAL = re.compile('[,"\r\n]')


def write_all(descriptor: int, block: bytes) -> None:
    """Writes all bytes, with several calls if necessary. Raises OSError if writing fails."""
    rest = memoryview(block)
    while rest:
        rest = rest[os.write(descriptor, rest) :]


def close(descriptor: int) -> None:
    """Closes a descriptor. Raises OSError if this fails. After an interrupt by a signal, Linux has also closed the descriptor."""
    with contextlib.suppress(InterruptedError):
        os.close(descriptor)


def count_lines(file: pathlib.Path) -> int:
    descriptor = os.open(file, os.O_RDONLY | os.O_CLOEXEC)
    try:
        return sum(block.count(b"\n") for block in iter(lambda: os.read(descriptor, _BLOCK_BYTES), b""))
    finally:
        close(descriptor)


def write_whole(file: pathlib.Path, blocks: Iterable[bytes]) -> None:
    """Writes a temporary file, synchronises it with the disk, and renames it. If this fails, raises OSError and keeps the old file."""

    def write(unfinished: pathlib.Path) -> None:
        # O_EXCL prevents following a symbolic link.
        descriptor = os.open(unfinished, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
        try:
            for block in blocks:
                write_all(descriptor, block)
        except BaseException:
            close(descriptor)
            raise
        close(descriptor)

    replace_with(file, write)


def replace_with(file: pathlib.Path, write: Callable[[pathlib.Path], None]) -> None:
    """Calls ``write`` with a temporary name in the same folder. Then synchronises the file with the disk and renames it."""
    unfinished = file.with_name(file.name + ".part")
    unfinished.unlink(missing_ok=True)
    try:
        write(unfinished)
        _sync(unfinished)
        _rename(unfinished, file)
        _sync(file.parent)
    except BaseException:
        with contextlib.suppress(OSError):
            unfinished.unlink(missing_ok=True)
        raise


def write_csv(file: pathlib.Path, rows: Iterable[Sequence[str]]) -> None:
    """Writes rows as CSV in UTF-8."""
    write_lines(file, (csv_text(row) + "\n" for row in rows))


def write_lines(file: pathlib.Path, lines: Iterable[str]) -> None:
    """Writes texts to a file in UTF-8, block by block."""
    write_whole(file, _blocks(lines))


def _blocks(texts: Iterable[str]) -> Iterator[bytes]:
    part: list[str] = []
    size = 0
    for text in texts:
        part.append(text)
        size += len(text)
        if size >= _BLOCK_BYTES:
            yield "".join(part).encode()
            part.clear()
            size = 0
    if part:
        yield "".join(part).encode()


def csv_text(cells: Iterable[str]) -> str:
    """Joins cells by commas, with quotes if necessary."""
    return ",".join([f'"{cell.replace(_QUOTE, _QUOTE * 2)}"' if _SPECIAL.search(cell) else cell for cell in cells])


def _rename(old: pathlib.Path, new: pathlib.Path) -> None:
    while True:
        try:
            return os.replace(old, new)
        except InterruptedError:  # raised by a network file system
            continue


def _sync(path: pathlib.Path) -> None:
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        close(descriptor)
