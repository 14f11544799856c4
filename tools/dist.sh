#!/bin/sh
# Build the sdist, and a wheel for each kind of robot's computer, into a folder: dist.sh FOLDER
#
# zig links the wheels, for either processor and for glibc 2.28 or newer, whatever this machine has. A Rust
# standard library belongs to one rustc: that on PATH is asked first, then /usr/bin/rustc, which is Debian's own
# where rustup's comes first.
set -eu

rustc_for() {
    for rustc in rustc /usr/bin/rustc; do
        library=$("$rustc" --print target-libdir --target "$1" 2>/dev/null) || continue
        if [ -d "$library" ]; then
            printf '%s\n' "$rustc"
            return
        fi
    done
}

maturin sdist --manifest-path rust/Cargo.toml --out "$1"
for processor in x86_64 aarch64; do
    target=$processor-unknown-linux-gnu
    rustc=$(rustc_for "$target")
    if [ -n "$rustc" ]; then
        RUSTC=$rustc maturin build --quiet --manifest-path rust/Cargo.toml --release --locked \
            --zig --target "$target" --compatibility manylinux_2_28 --out "$1"
    else
        echo "no wheel for $processor: Rust lacks its standard library; docs/how-to/install.md says how to get it" >&2
    fi
done
