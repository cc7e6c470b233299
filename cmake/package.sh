#!/usr/bin/env bash
# Makes a Debian package and an archive that can be unpacked anywhere, from an installed tree; of a build for Windows,
# the archive alone.
#
#     package.sh BUILD_FOLDER OUTPUT_FOLDER
#     package.sh --libraries PROGRAM           lists the libraries that the archive would contain
set -euo pipefail

# Left to the system are the C and C++ libraries and others that every system has: its graphics drivers use them, too,
# and need its version of them.
libraries() {
    ldd "$1" | sed -n 's/.* => \(\/[^ ]*\) .*/\1/p' \
        | grep -vE '/lib(c|m|dl|pthread|rt|stdc\+\+|gcc_s|z|tinfo|GL|EGL|OpenGL|GLX|GLdispatch|gbm|drm)\.so'
}

if [[ $1 == --libraries ]]; then
    libraries "$2"
    exit
fi

build=$(realpath "$1") out=$(realpath -m "$2")
source_folder=$(realpath "$(dirname "$0")/..")
version=$(sed -n 's/^project(feeler VERSION \([0-9.]*\).*/\1/p' "$source_folder/CMakeLists.txt")
architecture=$(dpkg --print-architecture)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
umask 022
mkdir -p "$out"

# installed TREE: the program with the fonts that an archive brings along.
installed() {
    cmake --install "$build" --prefix "$1" --strip >/dev/null
    cmake --install "$build" --prefix "$1" --component fonts >/dev/null
}

# common_licences FOLDER: adds the texts to which the licences in it refer, and which only Debian has.
common_licences() {
    local name
    mkdir "$1/common-licenses"
    grep -rhoE 'common-licenses/[A-Za-z0-9]+(-[0-9]+(\.[0-9]+)?)?' "$1" | sort -u | while IFS=/ read -r _ name; do
        cp -L "/usr/share/common-licenses/$name" "$1/common-licenses/"
    done
}

# --- Windows ---

if [[ -e $build/app/feeler.exe ]]; then
    name=feeler-$version-windows-x86_64
    installed "$work/$name"
    common_licences "$work/$name/licences"
    rm -f "$out/$name.zip"
    (cd "$work" && zip -q -r -X "$out/$name.zip" "$name")
    ls -l "$out/$name.zip"
    exit
fi

# --- Debian package ---

tree=$work/deb
DESTDIR=$tree cmake --install "$build" --prefix /usr --strip >/dev/null
doc=$tree/usr/share/doc/feeler
rm "$doc/LICENSE"
sed -i 's/](LICENSE)/](copyright)/' "$doc/README.md"
# As part of a paragraph of debian/copyright.
indented() { sed -e 's/^$/./' -e 's/^/ /'; }
{
    cat <<COPYRIGHT
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: feeler
Comment: The program contains code of Dear ImGui, GLM, tl::expected, CLI11 and
 JSON for Modern C++. Their licences are in /usr/share/doc/feeler/licences.

Files: *
Copyright: the authors of Feeler
License: Apache-2.0
 On Debian systems, the full text is in /usr/share/common-licenses/Apache-2.0.

Files: assets/programs/TEST_G90.NC assets/programs/PARALLEL.NC
Copyright: 2025-2026 MaestroFusion360
Comment: installed in /usr/share/feeler/programs
License: Expat
COPYRIGHT
    sed -n 's/^> \{0,1\}//p' "$source_folder/assets/programs/README.md" | indented
    printf '\nFiles: core/base/libm/*\nCopyright: the authors of musl; 1993 Sun Microsystems\nLicense: MIT\n'
    indented <"$source_folder/core/base/libm/COPYRIGHT"
    if [[ -e $doc/licences/three.js.txt ]]; then
        printf '\nFiles: three.js\nCopyright: the authors of three.js\n'
        printf 'Comment: a part of the program, for the 3D view of HTML reports\nLicense: MIT-three.js\n'
        indented <"$doc/licences/three.js.txt"
    fi
} >"$doc/copyright"
printf 'feeler (%s) stable; urgency=medium\n\n  * Version %s.\n\n -- Feeler <feeler@feeler.invalid>  %s\n' \
    "$version" "$version" "$(date -R -d "@${SOURCE_DATE_EPOCH:-$(date +%s)}")" \
    | gzip -9n >"$doc/changelog.gz"
gzip -9n "$tree"/usr/share/man/man1/*.1
mkdir -p "$tree/DEBIAN" "$work/debian"
printf 'Source: feeler\nPackage: feeler\n' >"$work/debian/control"
needs_of() {
    (cd "$work" && dpkg-shlibdeps -O --ignore-missing-info -e "$1" 2>/dev/null | sed -n 's/^shlibs:Depends=//p')
}
depends=$(needs_of "$tree/usr/bin/feeler")
reader=$tree/usr/lib/feeler/feeler-cad
for_reader=
[[ -e $reader ]] && for_reader=", $(needs_of "$reader")"
cat >"$tree/DEBIAN/control" <<CONTROL
Package: feeler
Version: $version
Architecture: $architecture
Maintainer: Feeler <feeler@feeler.invalid>
Installed-Size: $(du -sk --exclude=DEBIAN "$tree" | cut -f1)
Depends: $depends
Recommends: fonts-inter, fonts-jetbrains-mono, fonts-font-awesome, libgl1, libegl1, libopengl0, libgl1-mesa-dri$for_reader
Suggests: ffmpeg
Section: science
Priority: optional
Description: find collisions in NC programs before the machine does
 Feeler reads an NC program as the control does, moves tool and holder through
 the stock and past the fixtures, and reports the clearance of every block,
 with a proven lower bound. A viewer steps through the blocks and shows what
 collides.
CONTROL
(cd "$tree" && find usr -type f -print0 | sort -z | xargs -0 md5sum) >"$tree/DEBIAN/md5sums"
dpkg-deb --root-owner-group --build "$tree" "$out/feeler_${version}_$architecture.deb" >/dev/null

# --- archive ---

# Its program finds its libraries and fonts beside it.
name=feeler-$version-linux-$(uname -m)
tree=$work/$name
installed "$tree"
mv "$tree/share/doc/feeler/licences" "$tree/licences"

# Some libraries are in use only where the system has none: those of its graphics drivers, and OpenSSL, which it keeps
# secure.
own=$tree/lib/feeler
mkdir -p "$own/fallback"
libraries "$tree/bin/feeler" | while read -r library; do
    folder=$own
    [[ $library =~ /lib(X11|xcb|Xau|Xdmcp|bsd|md|edit|crypto)\.so ]] && folder=$own/fallback
    cp -L "$library" "$folder/"
    # In systems whose /lib is a link to /usr/lib, dpkg may know either path.
    file=$(realpath "$library")
    package=$({ dpkg-query -S "$file" || dpkg-query -S "${file#/usr}"; } 2>/dev/null | sed 's/:.*//')
    cp -L "/usr/share/doc/$package/copyright" "$tree/licences/$package.txt"
done
common_licences "$tree/licences"
system=$(dpkg-architecture -qDEB_HOST_MULTIARCH)
system=/lib/$system:/usr/lib/$system:/lib64:/usr/lib64:/usr/lib
# shellcheck disable=SC2016
patchelf --set-rpath '$ORIGIN/../lib/feeler:'"$system"':$ORIGIN/../lib/feeler/fallback' "$tree/bin/feeler"
if [[ -e $own/feeler-cad ]]; then
    # shellcheck disable=SC2016
    patchelf --set-rpath '$ORIGIN:'"$system"':$ORIGIN/fallback' "$own/feeler-cad"
fi
for library in "$own"/*.so*; do
    # shellcheck disable=SC2016
    patchelf --set-rpath '$ORIGIN:'"$system"':$ORIGIN/fallback' "$library"
done
for library in "$own"/fallback/*; do
    # shellcheck disable=SC2016
    patchelf --set-rpath "$system"':$ORIGIN' "$library"
done
# It loads the graphics driver by name, in the order of the system.
# shellcheck disable=SC2016
patchelf --set-rpath '$ORIGIN' "$own"/libepoxy.so.*
tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner -czf "$out/$name.tar.gz" "$name"
ls -l "$out"
