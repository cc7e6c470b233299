#!/usr/bin/env bash
# Makes a Debian package and an archive that can be unpacked anywhere, from an installed tree; of a build for Windows,
# the archive alone.
#
#     package.sh BUILD_FOLDER OUTPUT_FOLDER
set -euo pipefail
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

# --- Windows ---

if [[ -e $build/app/feeler.exe ]]; then
    name=feeler-$version-windows-x86_64
    installed "$work/$name"
    rm -f "$out/$name.zip"
    (cd "$work" && zip -q -r -X "$out/$name.zip" "$name")
    ls -l "$out/$name.zip"
    exit
fi

# --- Debian package ---

tree=$work/deb
DESTDIR=$tree cmake --install "$build" --prefix /usr --strip >/dev/null
doc=$tree/usr/share/doc/feeler
mv "$doc/LICENSE" "$work/LICENSE"
{
    printf 'Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n'
    printf 'Upstream-Name: feeler\n\nFiles: *\nCopyright: the authors of Feeler\nLicense: Apache-2.0\n'
    printf ' On Debian systems, the full text is in /usr/share/common-licenses/Apache-2.0.\n\n'
    printf 'Files: core/base/libm/*\nCopyright: the authors of musl; 1993 Sun Microsystems\nLicense: MIT\n'
    sed -e 's/^$/./' -e 's/^/ /' "$source_folder/core/base/libm/COPYRIGHT"
} >"$doc/copyright"
printf 'feeler (%s) stable; urgency=medium\n\n  * Version %s.\n\n -- Feeler <feeler@feeler.invalid>  %s\n' \
    "$version" "$version" "$(date -R -d "@${SOURCE_DATE_EPOCH:-$(date +%s)}")" \
    | gzip -9n >"$doc/changelog.gz"
gzip -9n "$tree"/usr/share/man/man1/*.1
mkdir -p "$tree/DEBIAN" "$work/debian"
printf 'Source: feeler\nPackage: feeler\n' >"$work/debian/control"
depends=$(cd "$work" && dpkg-shlibdeps -O --ignore-missing-info -e "$tree/usr/bin/feeler" 2>/dev/null \
    | sed -n 's/^shlibs:Depends=//p')
cat >"$tree/DEBIAN/control" <<CONTROL
Package: feeler
Version: $version
Architecture: $architecture
Maintainer: Feeler <feeler@feeler.invalid>
Installed-Size: $(du -sk --exclude=DEBIAN "$tree" | cut -f1)
Depends: $depends
Recommends: fonts-inter, fonts-jetbrains-mono, fonts-font-awesome, libgl1-mesa-dri, libegl1, libopengl0
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

# Its program finds its libraries and fonts beside it. The C library and the graphics driver are the system's.
name=feeler-$version-linux-$(uname -m)
tree=$work/$name
installed "$tree"
mkdir -p "$tree/lib/feeler"
ldd "$tree/bin/feeler" | sed -n 's/.* => \(\/[^ ]*\) .*/\1/p' \
    | grep -vE '/(libc|libm|libdl|libpthread|librt|ld-linux[^/]*|lib(GL|EGL|OpenGL|GLX|GLdispatch|gbm|drm))\.so' \
    | xargs -I{} cp -L {} "$tree/lib/feeler/"
# shellcheck disable=SC2016
patchelf --set-rpath '$ORIGIN/../lib/feeler' "$tree/bin/feeler"
# shellcheck disable=SC2016
for library in "$tree"/lib/feeler/*; do patchelf --set-rpath '$ORIGIN' "$library"; done
tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner -czf "$out/$name.tar.gz" "$name"
ls -l "$out"
