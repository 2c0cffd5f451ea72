# SPDX-License-Identifier: Apache-2.0
# For scripts that build Debian's libraries for other platforms.

# debian_sources FOLDER PACKAGE...
# Fetches the packages' sources with Debian's patches into FOLDER, with a separate configuration of apt.
debian_sources() {
  local place=$1 mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}
  shift
  rm -rf "$place"
  mkdir -p "$place/lists/partial" "$place/cache/archives/partial"
  echo "deb-src $mirror bookworm main" >"$place/sources.list"
  local options=(-qq -o "Dir::Etc::SourceList=$place/sources.list" -o Dir::Etc::SourceParts=- -o "Dir::State::Lists=$place/lists"
    -o "Dir::Cache=$place/cache" -o APT::Sandbox::User=root)
  apt-get "${options[@]}" update >/dev/null
  (cd "$place" && apt-get "${options[@]}" source "$@" >/dev/null)
}
