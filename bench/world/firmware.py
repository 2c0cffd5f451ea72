# SPDX-License-Identifier: Apache-2.0
"""Compiles unmodified sources from a checkout of crazyflie-firmware, together with a file of this folder that calls them, into a
library.
"""
import subprocess
from pathlib import Path

HERE = Path(__file__).resolve().parent
INCLUDE = ("src/modules/interface", "src/modules/interface/controller", "src/modules/interface/kalman_core", "src/hal/interface",
           "src/utils/interface", "src/utils/interface/lighthouse", "src/config", "src/drivers/interface", "src/platform/interface")


def compiled(checkout, folder, caller, sources):
    """Compiles the file `caller` of this folder together with `sources`, whose paths are relative to the checkout's src."""
    (folder / "autoconf.h").write_text("#define CONFIG_PLATFORM_CF2 1\n")
    library = folder / f"{caller}.so"
    checkout = checkout.resolve()
    subprocess.run(["gcc", "-shared", "-fPIC", "-O2", "-fno-strict-aliasing", "-w", "-DUNIT_TEST_MODE", f"-I{folder}",
                    f"-I{HERE / 'stand_in'}", *[f"-I{checkout / i}" for i in INCLUDE], "-o", library, HERE / f"{caller}.c",
                    *[checkout / "src" / f"{source}.c" for source in sources], "-lm"], check=True)
    return library
