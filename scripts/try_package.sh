#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs a package of MEbots in a clean Debian 12, and runs the included mission there. Removes the package and checks
# for remaining files. Needs root and debootstrap. Usage: scripts/try_package.sh FILE.deb|FILE.whl
set -euo pipefail
package=${1:?FILE.deb or FILE.whl}
if ((EUID != 0)) || ! command -v debootstrap >/dev/null; then
  echo "try_package.sh: a clean Debian needs root and debootstrap (apt-get install debootstrap)" >&2
  exit 2
fi
root=$(mktemp -d)
trap 'umount "$root/proc" 2>/dev/null || true; rm -rf --one-file-system "$root"' EXIT
debootstrap --variant=minbase bookworm "$root" "${DEBIAN_MIRROR:-http://deb.debian.org/debian}" >"$root/debootstrap.txt" \
  || { tail -5 "$root/debootstrap.txt" >&2; exit 1; }
mount -t proc proc "$root/proc"
mkdir "$root/package"
cp "$package" "$root/package/"

as_in() {  # as_in COMMANDS: executes the commands in the clean root
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive \
    PIP_DISABLE_PIP_VERSION_CHECK=1 /bin/bash -euo pipefail -c "$1"
}
fly='
cd /tmp
SECONDS=0
mebots demo --out flight --expect passed
test -s flight/flight.html
echo "flown after $SECONDS s"
'
as_in 'apt-get update -qq'
case $package in
  *.deb)
    as_in 'apt-get install -y -qq --no-install-recommends /package/*.deb >/dev/null 2>&1'
    as_in "$fly"
    as_in 'apt-get install -y -qq --no-install-recommends python3-numpy >/dev/null 2>&1
      python3 -c "import mebots; print(mebots.__version__)"
      mebots sweep --help >/dev/null
      apt-get remove -y -qq mebots >/dev/null 2>&1'
    ;;
  *.whl)
    as_in 'apt-get install -y -qq --no-install-recommends python3-venv ca-certificates >/dev/null 2>&1; python3 -m venv /opt/fresh'
    if [[ -n ${PIP_CERT:-} ]]; then cp "$PIP_CERT" "$root/etc/ssl/certs/ca-certificates.crt"; fi
    as_in 'PIP_CERT=/etc/ssl/certs/ca-certificates.crt /opt/fresh/bin/pip install --quiet /package/*.whl'
    as_in "export PATH=/opt/fresh/bin:\$PATH; $fly"
    as_in '/opt/fresh/bin/python -c "import mebots; print(mebots.__version__)"
      /opt/fresh/bin/pip uninstall --quiet --yes mebots'
    ;;
  *)
    echo "try_package.sh: $package is neither .deb nor .whl" >&2
    exit 2
    ;;
esac
left=$(find "$root" -xdev -iname '*mebots*' -not -path "$root/tmp/*" -not -path "$root/package/*" -not -path "$root/proc/*")
[[ -z $left ]] || { echo "FAILED: left behind:"; echo "$left"; exit 1; }
echo "ok: $(basename "$package") flies in a clean Debian 12, $(du -h "$package" | cut -f1), and leaves nothing behind"
