# SPDX-License-Identifier: Apache-2.0
# Tests that manual pages contain no errors, and that the installed shells complete commands, options and values.
set -euo pipefail
share=$MEBOTS/share
pages=$(find "$share/man/man1" -name '*.1' | wc -l)
((pages >= 15)) || { echo "FAILED: $pages manual pages"; exit 1; }
if command -v mandoc >/dev/null; then
  mandoc -T lint -W error "$share"/man/man1/*.1
  # Does not use a pipe into grep -q, which would sometimes fail: grep exits at its first match, and SIGPIPE then ends
  # the writer.
  grep -q 'mebots run configs/gate_easy.json --out' <<<"$(mandoc -T ascii "$share/man/man1/mebots-run.1")" \
    || { echo "FAILED: the page of mebots-run lacks its examples"; exit 1; }
fi
# Every program for users has a page and a completion. Every command in the help has a page.
for program in "$MEBOTS"/bin/*; do
  name=$(basename "$program")
  if [[ $name == mebots-fmu-host || $name == mebots-windows-host.exe ]]; then continue; fi  # the master starts these
  [[ -s $share/man/man1/$name.1 && -s $share/bash-completion/completions/$name ]] \
    || { echo "FAILED: $name has no page or no completion"; exit 1; }
done
for command in $(mebots --help | sed -n '/^Subcommands/,/^$/s/^  \([a-z-]*\) .*/\1/p'); do
  [[ -s $share/man/man1/mebots-$command.1 ]] || { echo "FAILED: mebots-$command has no page"; exit 1; }
done

touch a_config.json
completed() {  # completed PROGRAM WORD...: prints bash's completions of the last word
  bash -c '
    source "$0"
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
    "_${1//-/_}" 2>/dev/null
    printf "%s\n" "${COMPREPLY[@]}"' "$share/bash-completion/completions/$1" "$@"
}
expect() {  # expect TEXT WORD...
  local text=$1 offered
  shift
  offered=$(completed "$@")
  grep -qxF -e "$text" <<<"$offered" || { echo "FAILED: '$*' does not offer $text in bash, but: ${offered//$'\n'/ }"; exit 1; }
}
expect run mebots r
expect --stop-time mebots run --st
expect a_config.json mebots run a_
expect a_config.json mebots run --scenario a_
if [[ -x $MEBOTS/bin/mebots-boardgen ]]; then  # it has no commands
  expect --skeleton mebots-boardgen a_config.json --sk
  expect a_config.json mebots-boardgen a_
fi
if grep -q print-completion <<<"$(completed mebots run --print)"; then echo "FAILED: hidden options are offered"; exit 1; fi

if command -v fish >/dev/null; then
  offered=$(HOME=$PWD fish --no-config -c "source '$share/fish/vendor_completions.d/mebots.fish'; complete -C 'mebots run --st'")
  grep -q '^--stop-time' <<<"$offered" || { echo "FAILED: fish offers: $offered"; exit 1; }
fi
if command -v zsh >/dev/null; then
  # zsh completes only in an interactive line. Therefore this only loads the function, and zsh's own parser checks the
  # lists of options.
  zsh -f -c "autoload -Uz compinit && compinit -u -d '$PWD/zcompdump' && source '$share/zsh/site-functions/_mebots' && [[ \$_comps[mebots] == _mebots ]]" \
    || { echo "FAILED: zsh does not take the completion"; exit 1; }
fi
echo "ok: $pages manual pages; completion in bash$(command -v fish >/dev/null && echo ', fish')$(command -v zsh >/dev/null && echo ', zsh')"
