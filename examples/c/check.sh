#!/usr/bin/env bash
# Builds the library with its C interface, then the C and Fortran programs beside this file, and runs them.
# Usage: examples/c/check.sh [--release]; with valgrind installed, bad arguments are passed under it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
profile=debug
[[ "${1:-}" == --release ]] && profile=release
cargo rustc --lib --no-default-features --features capi --crate-type cdylib,staticlib "$@"
lib="${CARGO_TARGET_DIR:-target}/$profile"
out="$(mktemp -d)"
trap 'rm -rf "$out"' EXIT
flags=(-std=c11 -Wall -Wextra -Werror -O1 -Iinclude)

gcc "${flags[@]}" examples/c/first.c -o "$out/first" "-L$lib" -lcellfan -lm "-Wl,-rpath,$(realpath "$lib")"
gcc "${flags[@]}" examples/c/errors.c -o "$out/errors" "-L$lib" -lcellfan -lm "-Wl,-rpath,$(realpath "$lib")"
gcc "${flags[@]}" examples/c/first.c -o "$out/first_static" "$lib/libcellfan.a" -lm -lpthread -ldl
g++ -x c++ -fsyntax-only -Wall -Werror include/cellfan.h
gfortran -std=f2018 -Wall -Werror -O1 "-J$out" examples/fortran/cellfan.f90 examples/fortran/first.f90 -o "$out/first_fortran" \
    "-L$lib" -lcellfan "-Wl,-rpath,$(realpath "$lib")"

if command -v pkg-config >/dev/null; then
    # As it would be installed: below one prefix.
    mkdir -p "$out/prefix/lib/pkgconfig"
    ln -s "$PWD/include" "$out/prefix/include"
    ln -s "$(realpath "$lib")"/libcellfan.* "$out/prefix/lib/"
    version="$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)"
    sed "s|@prefix@|$out/prefix|; s|@version@|$version|" include/cellfan.pc.in >"$out/prefix/lib/pkgconfig/cellfan.pc"
    read -ra found <<<"$(PKG_CONFIG_PATH="$out/prefix/lib/pkgconfig" pkg-config --cflags --libs "cellfan = $version")"
    gcc -std=c11 examples/c/first.c -o "$out/first_found" "${found[@]}" -lm "-Wl,-rpath,$(realpath "$lib")"
    "$out/first_found" "$out/found.png"
fi

"$out/first" "$out/c.png"
"$out/first_static" "$out/static.png"
cmp "$out/c.png" "$out/static.png"
"$out/first_fortran" "$out/fortran.png"
if command -v valgrind >/dev/null; then
    # Wide vectors that valgrind does not know are not needed to look at arguments.
    valgrind --quiet --error-exitcode=9 --leak-check=full --show-leak-kinds=definite --errors-for-leak-kinds=definite "$out/errors"
else
    "$out/errors"
fi
if [[ -n "${CELLFAN_PICTURES:-}" ]]; then
    cp "$out"/*.png "$CELLFAN_PICTURES"
fi
