#!/bin/sh
# Installs the built library with its headers under a prefix: package/install.sh PREFIX BUILD-FOLDER
set -eu
[ $# = 2 ] || { echo "usage: $0 PREFIX BUILD-FOLDER" >&2; exit 2; }
crate=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$1"
prefix=$(cd "$1" && pwd)
built=$2
version=$(sed -n 's/^version = "\(.*\)"$/\1/p' "$crate/../../Cargo.toml" | head -n 1)
abi=$(sed -n 's/^pub const ABI_VERSION: u32 = \([0-9]*\);$/\1/p' "$crate/src/version.rs")

mkdir -p "$prefix/include" "$prefix/lib/cmake/Whipcord" "$prefix/lib/pkgconfig"
cp "$crate/include/whipcord.h" "$crate/include/whipcord.hpp" "$prefix/include/"
cp "$built/libwhipcord_c.a" "$prefix/lib/libwhipcord.a"
# A new file in place of the old one: a program that runs keeps the library that it has loaded.
cp "$built/libwhipcord_c.so" "$prefix/lib/libwhipcord.so.new"
mv -f "$prefix/lib/libwhipcord.so.new" "$prefix/lib/libwhipcord.so.$abi.$version"
ln -sf "libwhipcord.so.$abi.$version" "$prefix/lib/libwhipcord.so.$abi"
ln -sf "libwhipcord.so.$abi" "$prefix/lib/libwhipcord.so"
filled() {
    sed -e "s|@prefix@|$prefix|" -e "s|@version@|$version|" -e "s|@minor@|${version%.*}|" \
        -e "s|@static_libs@|-lpthread -ldl -lm|" "$crate/package/$1.in"
}
filled whipcord.pc > "$prefix/lib/pkgconfig/whipcord.pc"
filled WhipcordConfigVersion.cmake > "$prefix/lib/cmake/Whipcord/WhipcordConfigVersion.cmake"
cp "$crate/package/WhipcordConfig.cmake" "$prefix/lib/cmake/Whipcord/"
echo "installed whipcord $version in $prefix"
