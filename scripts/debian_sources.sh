# SPDX-License-Identifier: Apache-2.0
# For scripts that build Debian's libraries for other platforms. Each step runs once, so an interrupted script continues
# where it stopped.

# begin_sysroot SYSROOT SOURCES WANTED
# Creates the folders for libraries and sources. WANTED describes the build: if it has changed, deletes the files of
# earlier runs.
begin_sysroot() {
  steps=$1/.steps
  log=$2/build.txt
  if [[ $(cat "$steps/wanted" 2>/dev/null) != "$3" ]]; then
    rm -rf "$1" "$2"
    mkdir -p "$steps" "$2"
    echo "$3" >"$steps/wanted"
  fi
  exec 3>&2  # keeps stderr: a step that fails ends the script while its errors still go to the log
  trap 'if (($?)); then tail -n 20 "$log" >&3; echo "$(basename "$0"): failed; the whole output is in $log" >&3; fi' EXIT
}

# step NAME COMMAND...
# Executes COMMAND with its output in the log, and prints the time that it took. If COMMAND has succeeded before, does
# nothing.
step() {
  local name=$1
  shift
  if [[ -e $steps/$name ]]; then return; fi
  local TIMEFORMAT
  TIMEFORMAT="$(basename "$0"): $name in %0R s; processor time %0U s + %0S s"
  time "$@" >>"$log" 2>&1
  touch "$steps/$name"
}

# debian_sources FOLDER PACKAGE...
# Fetches the packages' sources with Debian's patches into FOLDER. Uses a separate configuration of apt.
debian_sources() {
  local place=$1 mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}
  shift
  find "$place" -mindepth 1 -maxdepth 1 ! -name build.txt -exec rm -rf {} +  # apt-get would keep a folder that is not completely unpacked
  mkdir -p "$place/lists/partial" "$place/cache/archives/partial"
  echo "deb-src $mirror bookworm main" >"$place/sources.list"
  local options=(-qq -o "Dir::Etc::SourceList=$place/sources.list" -o Dir::Etc::SourceParts=- -o "Dir::State::Lists=$place/lists"
    -o "Dir::Cache=$place/cache" -o APT::Sandbox::User=root)
  apt-get "${options[@]}" update
  (cd "$place" && apt-get "${options[@]}" source "$@")
}
