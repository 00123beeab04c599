#!/usr/bin/env bash
# Checks that a fresh Debian 12 runs peristat. Makes a minimal system in a temporary folder, copies this
# tree into it, and runs a user's first commands there. Prints the seconds of each command. Needs root,
# debootstrap and 3 GB in TMPDIR; removes its files at the end.
#   benchmarks/bare_debian.sh              run a case, then the tests
#   benchmarks/bare_debian.sh COMMAND...   each argument is one command line for ./peristat
#   benchmarks/bare_debian.sh --package FILE.deb [COMMAND...]
#                                          installs the package instead, without a compiler; by
#                                          default it runs a case and looks for its pictures
set -euo pipefail

release=bookworm
tree=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
((EUID == 0)) || { echo "bare_debian.sh: only root may make a system and enter it" >&2; exit 2; }
package=''
if [[ ${1-} == --package ]]; then
  package=$(readlink -e -- "${2-}") || { echo "bare_debian.sh: no package \"${2-}\"" >&2; exit 2; }
  shift 2
fi
peristat=${package:+peristat} && peristat=${peristat:-./peristat}
case_file=${package:+/usr/share/peristat/}cases/plate_with_hole/elastic.toml
if ! (($#)); then
  set -- "run $case_file"
  [[ $package ]] || set -- "$@" test
fi

# The mirror that this machine uses.
mirror=$(apt-get indextargets --format '$(ORIGIN) $(CODENAME) $(REPO_URI)' |
  sed -n "s/^Debian $release //p" | sort -u | head -n 1)
[[ $mirror ]] || { echo "bare_debian.sh: no mirror of $release here; apt-get update?" >&2; exit 2; }

system=$(mktemp -d)
clean_up() {
  local mounted
  for mounted in dev proc; do
    mountpoint -q "$system/$mounted" && umount --lazy "$system/$mounted"
  done
  rm -rf --one-file-system "$system"
}
trap clean_up EXIT
trap 'exit 130' INT TERM HUP

report=()
timed() {  # timed NAME COMMAND...
  local name=$1 started=$SECONDS status=0
  shift
  echo "== $name"
  "$@" || status=$?
  report+=("$((SECONDS - started)) s, exit code $status: $name")
  return "$status"
}

secure=()
[[ $mirror == https:* ]] && secure=(--include=ca-certificates)  # such a mirror needs them
timed "debootstrap --variant=minbase $release" \
  debootstrap --variant=minbase "${secure[@]}" "$release" "$system" "$mirror" >"$system.log" ||
  { tail "$system.log"; rm -f "$system.log"; exit 1; }
rm -f "$system.log"

# The same package sources and proxy as on this machine.
rm -f "$system/etc/apt/sources.list"
for file in /etc/apt/sources.list /etc/apt/sources.list.d/*; do
  [[ -f $file ]] && grep -qF "${mirror%/}" "$file" && cp "$file" "$system${file}"
done
for file in /etc/apt/apt.conf /etc/apt/apt.conf.d/*; do
  [[ -f $file ]] && grep -q '^ *Acquire' "$file" && cp "$file" "$system${file}"
done
cp -L /etc/resolv.conf /etc/hosts "$system/etc/"
mount -t proc proc "$system/proc"
mount --bind /dev "$system/dev"

environment=(PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root)
for name in http_proxy https_proxy no_proxy; do
  [[ -v $name ]] && environment+=("$name=${!name}")
done
enter() { env -i "${environment[@]}" chroot "$system" bash -c "$1" </dev/null; }
mkdir -p "$system/opt/peristat"
status=0 since=$SECONDS
if [[ $package ]]; then
  cp "$package" "$system/opt/"
  install="apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install --yes -qq"
  timed "apt-get update and install" enter "$install /opt/${package##*/}" || exit 1
  enter "ldd /usr/libexec/peristat/peristat | grep libperistat"  # which of the two
  for compiler in c++ g++ cc gcc clang; do
    if enter "command -v $compiler"; then
      echo "bare_debian.sh: the package has brought a compiler" >&2
      status=1
    fi
  done
else
  git -C "$tree" ls-files -z --cached --others --exclude-standard |
    tar -C "$tree" --null --files-from=- --ignore-failed-read -c |
    tar -C "$system/opt/peristat" --no-same-owner -x
fi

for line; do
  timed "$peristat $line" enter "cd /opt/peristat && $peristat $line" || status=1
done
if [[ $package && $* == "run $case_file" ]]; then
  enter "ls /opt/peristat/results/plate_with_hole_elastic/plots/*.png" || status=1
  report+=("$((SECONDS - since)) s from nothing to the first pictures")
fi
printf '\n'
printf '%s\n' "${report[@]}"
exit "$status"
