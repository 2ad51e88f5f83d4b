#!/bin/sh
# Tests the installed C and C++ interface as its users meet it: a prefix, an empty folder, the examples, and no source of Whipcord.
#     package/test.sh BUILD-FOLDER WHIPCORD-COMMAND
set -eu
[ $# = 2 ] || { echo "usage: $0 BUILD-FOLDER WHIPCORD-COMMAND" >&2; exit 2; }
crate=$(cd "$(dirname "$0")/.." && pwd)
root=$(cd "$crate/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
prefix=$folder/prefix
work=$folder/work
mkdir "$work"
"$crate/package/install.sh" "$prefix" "$1"
whipcord=$(cd "$(dirname "$2")" && pwd)/$(basename "$2")
cp "$crate"/examples/* "$work"
cp -r "$root/examples/table1" "$root/examples/two-segment-arm.toml" "$root/examples/reaching-arm.toml" \
    "$root/examples/released-arm.toml" "$work"
cd "$work"

strict="-Wall -Wextra -Werror -pedantic -O2"
if command -v pkg-config >/dev/null; then
    PKG_CONFIG_PATH=$prefix/lib/pkgconfig
    export PKG_CONFIG_PATH
    flags="$(pkg-config --cflags whipcord) $(pkg-config --libs whipcord)"
    static="$(pkg-config --cflags whipcord) $prefix/lib/libwhipcord.a $(pkg-config --libs --static whipcord | sed 's/-lwhipcord//')"
else
    echo "no pkg-config: the examples are built with paths, whipcord.pc is not tested (Debian: apt-get install pkg-config)" >&2
    flags="-I$prefix/include -L$prefix/lib -lwhipcord"
    static="-I$prefix/include $prefix/lib/libwhipcord.a -lpthread -ldl -lm"
fi
# The flags are words.
# shellcheck disable=SC2086
{
    gcc -std=c11 $strict solve.c $flags -Wl,-rpath,"$prefix/lib" -o solve
    gcc -std=c11 $strict control_loop.c $flags -lm -Wl,-rpath,"$prefix/lib" -o control_loop
    g++ -std=c++17 $strict reach.cpp $flags -Wl,-rpath,"$prefix/lib" -o reach
    g++ -std=c++17 $strict simulate.cpp $flags -Wl,-rpath,"$prefix/lib" -o simulate
    cp "$crate/package/test_wrapper.cpp" .
    g++ -std=c++17 $strict test_wrapper.cpp $flags -Wl,-rpath,"$prefix/lib" -o test_wrapper
    # The header of C in C++, and the static library.
    g++ -std=c++17 $strict -x c++ -include whipcord.h -c /dev/null -I"$prefix/include" -o header.o
    gcc -std=c11 $strict solve.c $static -o solve_static
}
if ldd ./solve_static | grep whipcord; then echo "solve_static needs the shared library" >&2; exit 1; fi
ldd ./solve | grep -q "libwhipcord.so.1 => $prefix/lib"
./test_wrapper two-segment-arm.toml

# A solve of C is that of the command, to the last bit.
for robot in table1/case-3.toml two-segment-arm.toml; do
    for model in cosserat cosserat-disks piecewise-constant-curvature pseudo-rigid-body; do
        "$whipcord" solve "$robot" --model "$model" --json > answer.json 2> warnings.txt
        ./solve "$robot" "$model" > answer.txt
        ./solve_static "$robot" "$model" | cmp - answer.txt
        python3 "$crate/package/same_bits.py" answer.json answer.txt
    done
done
echo "equal to whipcord solve to the last bit"

if ./solve nothing.toml 2> message.txt; then echo "a file that is not there was solved" >&2; exit 1; fi
grep -q "nothing.toml" message.txt
./control_loop two-segment-arm.toml 300
./reach reaching-arm.toml
if ./reach reaching-arm.toml 5 0 0 > far.txt; then echo "a point 5 m away was reached" >&2; exit 1; fi
grep -q "not reached" far.txt
./simulate released-arm.toml 0.5 | tail -n 2

# The programs of the documentation, as they are printed there.
cp two-segment-arm.toml arm.toml
printed() { awk -v begin="^\`\`\`$1\$" '$0 ~ begin { on = 1; next } /^```/ { on = 0 } on' "$root/docs/c-and-cpp.md"; }
printed c > page.c
printed cpp > page.cpp
# shellcheck disable=SC2086
{
    gcc -std=c11 $strict page.c $flags -Wl,-rpath,"$prefix/lib" -o page_c
    g++ -std=c++17 $strict page.cpp $flags -Wl,-rpath,"$prefix/lib" -o page_cpp
}
./page_c | grep -q "^tip at 0.0477636 "
./page_cpp | head -n 1 | grep -q "^0.0477636$"
echo "the programs of the page run"

if command -v cmake >/dev/null; then
    mkdir sources
    cp "$crate"/examples/* sources
    cmake -S sources -B build -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_FLAGS="-Wall -Wextra -Werror" \
        -DCMAKE_CXX_FLAGS="-Wall -Wextra -Werror" > cmake.txt || { cat cmake.txt; exit 1; }
    cmake --build build > cmake.txt || { cat cmake.txt; exit 1; }
    ./build/solve two-segment-arm.toml pseudo-rigid-body | cmp - answer.txt
    ./build/reach reaching-arm.toml > /dev/null
    echo "built by CMake"
else
    echo "skipped: no CMake, the package for it is not tested (Debian: apt-get install cmake)" >&2
fi

# Not by valgrind: that of Debian 12 does not know each AVX instruction that LLVM emits (vmovq between registers in its second form).
sanitize="-g -fsanitize=address,undefined -fno-sanitize-recover=all"
# shellcheck disable=SC2086
if echo "int main(void) { return 0; }" | gcc $sanitize -x c - -o sanitized 2> /dev/null; then
    gcc -std=c11 $strict $sanitize solve.c $flags -Wl,-rpath,"$prefix/lib" -o solve_checked
    g++ -std=c++17 $strict $sanitize test_wrapper.cpp $flags -Wl,-rpath,"$prefix/lib" -o test_wrapper_checked
    g++ -std=c++17 $strict $sanitize reach.cpp $flags -Wl,-rpath,"$prefix/lib" -o reach_checked
    g++ -std=c++17 $strict $sanitize simulate.cpp $flags -Wl,-rpath,"$prefix/lib" -o simulate_checked
    ./solve_checked two-segment-arm.toml > /dev/null
    ./test_wrapper_checked two-segment-arm.toml > /dev/null
    ./reach_checked reaching-arm.toml > /dev/null
    ./simulate_checked released-arm.toml 0.5 > /dev/null
    # What is not freed is found.
    sed 's/whipcord_robot_free(robot);/robot = NULL;/' solve.c > leak.c
    gcc -std=c11 $strict $sanitize leak.c $flags -Wl,-rpath,"$prefix/lib" -o leak
    if ./leak two-segment-arm.toml > /dev/null 2> leak.txt; then echo "a leak was not found" >&2; exit 1; fi
    grep -q "leaked in" leak.txt
    echo "no error by the sanitizers of addresses, leaks and undefined behaviour"
else
    echo "skipped: gcc has no sanitizers" >&2
fi

if command -v mkoctfile >/dev/null && command -v octave-cli >/dev/null; then
    # shellcheck disable=SC2086
    mkoctfile --mex whipcord_tip.c $flags -Wl,-rpath,"$prefix/lib"
    ./solve two-segment-arm.toml cosserat | head -n 1 | cut -d ' ' -f 2- > tip.txt
    octave-cli --quiet --no-init-file --path "$work" "$crate/package/test_mex.m"
else
    echo "skipped: no Octave with mkoctfile, the MEX example is not tested (Debian: apt-get install octave-dev)" >&2
fi
