#!/usr/bin/env bash
# Fetches the sources of the libraries for the Windows build, as Debian 12 has them.
#
#     fetch.sh [FOLDER]        default: build/deps
#
# Needs no root and changes nothing in the system's configuration. FEELER_DEBIAN_MIRROR names another
# mirror, which must have debian and debian-security.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
folder=$(realpath -m "${1:-$here/../../build/deps}")
mirror=${FEELER_DEBIAN_MIRROR:-http://deb.debian.org}
keyring=/usr/share/keyrings/debian-archive-keyring.gpg

say() { printf 'fetch.sh: %s\n' "$*" >&2; }

die() {
    say "$*"
    exit 1
}

# What is there is complete, because a package is moved there as the last step.
missing=()
while read -r package part; do
    [[ -e $folder/$package ]] || missing+=("$package $part")
done < <(sed -e 's/#.*//' -e '/^$/d' "$here/packages.txt")
((${#missing[@]})) || exit 0

command -v apt-get >/dev/null || die "no apt-get: this needs Debian"
command -v dpkg-source >/dev/null || die "no dpkg-source: install the package dpkg-dev"
[[ -e $keyring ]] || die "no $keyring: install the package debian-archive-keyring"

mkdir -p "$folder"
work=$(mktemp -d "$folder/.fetch.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir -p "$work"/{lists,cache,source}
for kind in deb deb-src; do
    cat <<LIST
$kind [signed-by=$keyring] $mirror/debian bookworm main
$kind [signed-by=$keyring] $mirror/debian bookworm-updates main
$kind [signed-by=$keyring] $mirror/debian-security bookworm-security main
LIST
done >"$work/sources.list"
# root cannot become _apt in a folder of a user, hence Sandbox. Hooks would act on the system.
cat >"$work/apt.conf" <<CONF
#clear APT::Update::Post-Invoke;
#clear APT::Update::Post-Invoke-Success;
APT::Sandbox::User "$(id -un)";
APT::Update::Error-Mode "any";
Acquire::http::Timeout "30";
Acquire::Retries "2";
Dir::Cache "$work/cache";
Dir::State::lists "$work/lists";
Dir::Etc::sourcelist "$work/sources.list";
Dir::Etc::sourceparts "-";
Dir::Etc::preferences "-";
Dir::Etc::preferencesparts "-";
CONF
apt() { apt-get -q -c "$work/apt.conf" "$@" </dev/null >"$work/log" 2>&1; }

apt update || {
    grep '^[EW]:' "$work/log" | sort -u >&2 || true
    die "cannot read the lists of $mirror: is there a network? FEELER_DEBIAN_MIRROR names another mirror"
}

# Fetches and unpacks a source package: the newest version that the mirror has. Its lists may name one whose files
# it does not have.
source_of() {
    local package=$1 version
    shift
    for version in $(apt-cache -c "$work/apt.conf" showsrc --only-source "$package" \
        | sed -n 's/^Version: //p' | sort -ruV); do
        apt source --only-source "$@" "$package=$version" && return
        grep -q ' 404 ' "$work/log" || return 1
        say "the mirror does not have $package $version: trying the one before"
    done
    return 1
}

# Debian has the source of GCC, whose source package is large, in a package of its own, too.
paths_of_gcc() {
    apt download gcc-12-source && mkdir libstdc++ \
        && dpkg-deb --fsys-tarfile gcc-12-source_*.deb \
        | tar -xO --wildcards ./usr/src/gcc-12/gcc-\*.tar.xz \
            | tar -xJ -C libstdc++ --strip-components=4 --wildcards '*/src/c++17/fs_path.cc'
}

for entry in "${missing[@]}"; do
    read -r package part <<<"$entry"
    say "fetching $package"
    mkdir "$work/source/$package"
    cd "$work/source/$package"
    if [[ $part == orig ]]; then
        source_of "$package" --tar-only && tar -xf ./*.orig.tar.*
    elif [[ $part == paths ]]; then
        paths_of_gcc
    else
        source_of "$package"
    fi || {
        cat "$work/log" >&2
        die "cannot fetch the source package $package"
    }
    mv -T "$(find . -mindepth 1 -maxdepth 1 -type d)" "$folder/$package"
done
