# SPDX-License-Identifier: Apache-2.0
"""Reads pictures and vectors and converts them to inputs of a network."""

from __future__ import annotations

import dataclasses
import pathlib
from collections.abc import Iterator

import numpy as np

from mebots.deploy.arithmetic import Scale
from mebots.deploy.graph import Tensor
from mebots.errors import InputError
from mebots.extras import extra

_SUFFIXES = (".pgm", ".png", ".ppm", ".jpg", ".jpeg", ".bmp")
MOST_PICTURES = 100_000


@dataclasses.dataclass(frozen=True)
class Crop:
    """The part of a picture that is the input of the network."""

    left: int
    top: int


class Pictures:
    """The inputs in a folder of pictures, or in a .npy file of vectors with the shape (number, *shape). ``one`` and ``bytes`` return bytes
    in the order rows, columns, channels."""

    def __init__(self, path: pathlib.Path, tensor: Tensor, crop: Crop | None, whole: Tensor | None = None) -> None:
        """Reads the file of vectors, or lists the pictures. If ``whole`` is given, the files contain inputs of its size, which are then
        reduced to the size of ``tensor``."""
        self.path = path
        self._tensor = tensor
        self._whole = whole or tensor
        self._crop = crop
        self.vectors: np.ndarray | None = None
        self.files: list[pathlib.Path] = []
        if path.suffix == ".npy":
            self.vectors = _vectors(path, self._whole)
            return
        if len(tensor.shape) != 3 or tensor.channels not in (1, 3):
            raise InputError(
                f"{path}: the network's input {tensor.name} has shape {[1, *tensor.shape]}, which is no picture; --data must be a .npy file with shape [number, *shape]",
                "invalid_data",
            )
        self.files = _files(path)

    def __len__(self) -> int:
        return len(self.files) if self.vectors is None else len(self.vectors)

    def scale(self, step: float, offset: float) -> Scale:
        """Returns the scale of the input: real = byte x step + offset. Computes the scale of vectors from their range."""
        if self.vectors is not None:
            return Scale.of_range(float(self.vectors.min()), float(self.vectors.max()))
        zero = -offset / step
        if abs(zero - round(zero)) > 1e-3 or not 0 <= round(zero) <= 255:
            raise InputError(
                f"the input's real value 0 is byte {zero:.3f}; it must be a whole number from 0 to 255. Change --input-offset or --input-scale, "
                "or subtract the mean inside of the network",
                "invalid_data",
            )
        return Scale(step, int(round(zero)))

    def bytes(self, scale: Scale) -> Iterator[np.ndarray]:
        for number in range(len(self)):
            yield self.one(number, scale)

    def chosen(self, most: int) -> list[int]:
        """Returns the numbers of at most ``most`` equally spaced inputs."""
        return [int(one) for one in np.linspace(0, len(self) - 1, min(most, len(self))).round()]

    def places(self) -> dict[str, int]:
        """Maps the name of each input to its number. The name is the path in the folder, or the number of a vector."""
        if self.vectors is not None:
            return {str(i): i for i in range(len(self.vectors))}
        return {one.relative_to(self.path).as_posix(): i for i, one in enumerate(self.files)}

    def naming(self) -> str:
        return "files as in the folder of pictures" if self.vectors is None else f"vectors by numbers from 0 to {len(self) - 1}"

    def one(self, number: int, scale: Scale) -> np.ndarray:
        """Returns the bytes of the input with this number, in the order rows, columns, channels."""
        if self.vectors is None:
            values = self._read(self.files[number])
        else:
            values = scale.bytes(self.vectors[number])
            values = np.moveaxis(values.reshape(self._whole.channels, self._whole.rows, self._whole.columns), 0, 2)
        return values if self._whole is self._tensor else self._reduced(values)

    def _reduced(self, values: np.ndarray) -> np.ndarray:
        image = extra("PIL.Image", "`mebots deploy`", "pillow", "deploy")
        size = self._tensor.columns, self._tensor.rows
        planes = [np.asarray(image.fromarray(np.ascontiguousarray(values[:, :, i])).resize(size, image.Resampling.BOX)) for i in range(values.shape[2])]
        return np.stack(planes, axis=2)

    def _read(self, path: pathlib.Path) -> np.ndarray:
        image = extra("PIL.Image", "`mebots deploy`", "pillow", "deploy")
        rows, columns, channels = self._whole.stored()
        try:
            with image.open(path) as picture:
                values = np.asarray(picture.convert("L" if channels == 1 else "RGB"), dtype=np.uint8)
        except Exception as error:  # Pillow raises many classes of errors for damaged files
            raise InputError(f"{path}: is not a readable picture: {error}", "invalid_data") from error
        values = values.reshape(*values.shape[:2], channels)
        if values.shape[:2] == (rows, columns):
            return values
        crop = self._crop
        if crop is not None and crop.top + rows <= values.shape[0] and crop.left + columns <= values.shape[1]:
            return values[crop.top : crop.top + rows, crop.left : crop.left + columns]
        has = f"{values.shape[1]} x {values.shape[0]}"
        way = "--crop LEFT,TOP selects a part of larger pictures" if crop is None else f"the crop at {crop.left},{crop.top} exceeds it"
        raise InputError(f"{path}: has {has} pixels, the network's input {self._tensor.name} {columns} x {rows}. Resize it; {way}", "invalid_data")

    def real(self, stored: np.ndarray, scale: Scale) -> np.ndarray:
        """Converts stored bytes of an input to real numbers in the ONNX shape."""
        return self._tensor.view(scale.real(stored).astype(np.float32))[np.newaxis]


def _vectors(path: pathlib.Path, tensor: Tensor) -> np.ndarray:
    try:
        values = np.load(path, allow_pickle=False)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: is not a readable .npy file: {error}", "invalid_data") from error
    if values.ndim == len(tensor.shape) + 2 and values.shape[1] == 1:
        values = values[:, 0]
    if values.shape[1:] != tensor.shape or len(values) == 0 or values.dtype.kind not in "fiu":
        raise InputError(
            f"{path}: has shape {list(values.shape)} of type {values.dtype}; numbers of shape [number, {', '.join(map(str, tensor.shape))}] are expected", "invalid_data"
        )
    if not np.isfinite(values).all():
        raise InputError(f"{path}: has values that are not finite", "invalid_data")
    return values.astype(np.float32)


def _files(path: pathlib.Path) -> list[pathlib.Path]:
    if not path.is_dir():
        raise InputError(f"{path}: is not a folder of pictures nor a .npy file", "not_found")
    files = sorted(one for one in path.rglob("*") if one.suffix.lower() in _SUFFIXES)
    if not files:
        raise InputError(f"{path}: has no pictures ({', '.join(_SUFFIXES)})", "invalid_data")
    return files[:MOST_PICTURES]
