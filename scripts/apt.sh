# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# To be sourced: how the scripts of this folder call apt-get.

# apt_get_as_root ARGUMENT...: as root, by sudo if need be. What apt-get prints
# is long and of use only when it fails.
apt_get_as_root() {
  local as_root=() log
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      echo "$(basename "$0"): run it as root, or install sudo" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  log=$(mktemp)
  if ! "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
      apt-get -qq -o Dpkg::Use-Pty=0 "$@" >"$log" 2>&1; then
    cat "$log" >&2
    rm -f "$log"
    echo "$(basename "$0"): apt-get $1 failed, see above" >&2
    return 1
  fi
  rm -f "$log"
}

# install_packages PACKAGE...: installs those that are missing; needs neither
# root rights nor a network where none is.
install_packages() {
  local package state missing=()
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "$(basename "$0"): no apt-get on this system; install by hand what" \
         "stands for: $*" >&2
    return 1
  fi
  for package in "$@"; do
    state=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null ||
            true)
    [[ $state == installed ]] || missing+=("$package")
  done
  if ((${#missing[@]} == 0)); then
    echo "$(basename "$0"): all $# packages are installed"
    return 0
  fi
  echo "$(basename "$0"): installing ${missing[*]}"
  apt_get_as_root update &&
    apt_get_as_root install -y --no-install-recommends "${missing[@]}"
}
