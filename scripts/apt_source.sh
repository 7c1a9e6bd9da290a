# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# To be sourced: source packages of the distribution. The entries for them, their
# lists and the cache are kept in the folder that apt_folder names; the system's
# lists stay as they are.

# apt_sources COMMAND...: with entries for source packages of the configured
# suites, and nothing else.
apt_sources() {
  "$@" -qq -o APT::Sandbox::User=root \
    -o Dir::Etc::sourcelist="$apt_folder/sources.list" \
    -o Dir::Etc::sourceparts=/dev/null \
    -o Dir::State::lists="$apt_folder/lists" \
    -o Dir::Cache="$apt_folder/cache"
}

# read_apt_sources: gets the lists; fails where apt knows no suite.
read_apt_sources() {
  local keys=() keyring origin signed=
  mkdir -p "$apt_folder/lists/partial" "$apt_folder/cache/archives/partial"
  for keyring in debian ubuntu; do
    if [[ -f /usr/share/keyrings/$keyring-archive-keyring.gpg ]]; then
      keys+=("/usr/share/keyrings/$keyring-archive-keyring.gpg")
    fi
  done
  ((${#keys[@]} == 0)) || signed="[signed-by=$(IFS=,; echo "${keys[*]}")] "
  # In the system's order, which decides between two places with one version.
  for origin in Debian Ubuntu; do
    apt-get indextargets "Identifier: Packages" "Origin: $origin" --format \
      "deb-src $signed\$(REPO_URI) \$(RELEASE) \$(COMPONENT)"
  done | awk '!seen[$0]++' >"$apt_folder/sources.list"
  [[ -s $apt_folder/sources.list ]] || return 1
  # Without a network the lists of an earlier run will do. Lists that cannot be
  # fetched are no error to apt-get unless it is told so.
  apt_sources apt-get update -o APT::Update::Error-Mode=any ||
    echo "$(basename "$0"): going on with the package lists that are here" >&2
}

# source_versions PACKAGE: all that the lists have, the newest last.
source_versions() {
  { apt_sources apt-cache showsrc --only-source "$1" || true; } |
    sed -n 's/^Version: //p' | sort -Vu
}

# unpack_source PACKAGE VERSION FOLDER: into a new FOLDER, patched as the
# distribution has it. Unpacked beside and moved, so that what is there is whole.
unpack_source() {
  rm -rf "$3.fetch"
  mkdir -p "$3.fetch"
  (cd "$3.fetch" && apt_sources apt-get source "$1=$2") || return
  rm -rf "$3" && mv "$3.fetch"/*/ "$3" || return
  rm -rf "$3.fetch"
}
