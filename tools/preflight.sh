#!/bin/sh
# Print the Python to use, or one line per thing that is missing, with its remedy, and fail.
#
# Asked for: Python >= 3.11 with venv and ensurepip, cargo and rustc >= 1.85, a C linker called cc.
# PYTHON=/path/to/python overrides the search. Only shell built-ins are used, since a bare machine is
# exactly where this runs.

PYTHON_MINOR=11
RUST_MINOR=85
missing=0

complain() {
    printf 'vedette: %s\n' "$1" >&2
    missing=1
}

runs() {
    command -v "$1" >/dev/null 2>&1 && "$@" >/dev/null 2>&1
}

# Set `python` to the first that is new enough and can make an environment.
find_python() {
    python='' old='' bare=''
    for candidate in "$@"; do
        runs "$candidate" -c '' || continue
        if ! runs "$candidate" -c "import sys; sys.exit(sys.version_info < (3, $PYTHON_MINOR))"; then
            old=${old:-$candidate}
        elif ! runs "$candidate" -c 'import venv, ensurepip'; then
            bare=${bare:-$candidate}
        else
            python=$candidate
            return
        fi
    done
    remedy="install Python 3.$PYTHON_MINOR or newer, or name one: make explore PYTHON=/path/to/python3"
    if [ -n "$bare" ]; then
        complain "$bare cannot make an environment: install its venv and ensurepip modules (Debian, Ubuntu: apt install python3-venv)"
    elif [ -n "$old" ]; then
        version=$("$old" -c 'import platform; print(platform.python_version())')
        complain "$old is Python $version, too old: $remedy"
    else
        complain "Python not found (tried $*): $remedy"
    fi
}

check_environment() {
    [ -x .venv/bin/python ] || return 0
    runs .venv/bin/python -c "import sys; sys.exit(sys.version_info < (3, $PYTHON_MINOR))" ||
        complain ".venv holds a Python that is broken or older than 3.$PYTHON_MINOR: remove it with make clean"
}

check_rust() {
    for tool in cargo rustc; do
        if ! command -v $tool >/dev/null 2>&1; then
            if [ -x "${HOME:-}/.cargo/bin/$tool" ]; then
                complain "$tool is not on PATH: run  . ~/.cargo/env  and try again"
            else
                complain "$tool not found: install Rust 1.$RUST_MINOR or newer from https://rustup.rs and open a new shell"
            fi
            return
        fi
    done
    cargo --version >/dev/null 2>&1 || {
        complain 'cargo does not run: choose a toolchain with  rustup default stable'
        return
    }
    version=$(rustc --version 2>/dev/null)  # "rustc 1.85.0 (4d91de4e4 2025-02-17)"
    version=${version#rustc }
    version=${version%% *}
    major=${version%%.*}
    minor=${version#*.}
    minor=${minor%%.*}
    case $major.$minor in
        *[!0-9.]* | .* | *.)
            complain 'rustc does not run: choose a toolchain with  rustup default stable'
            return
            ;;
    esac
    if [ "$major" -eq 1 ] && [ "$minor" -lt $RUST_MINOR ]; then
        complain "rustc is $version, too old: get Rust 1.$RUST_MINOR or newer with  rustup update stable"
    fi
}

check_linker() {
    runs cc --version ||
        complain 'no C linker (cc): install one (Debian, Ubuntu: apt install gcc libc6-dev; Fedora: dnf install gcc)'
}

if [ -n "${PYTHON:-}" ]; then
    find_python "$PYTHON"
else
    find_python python3 python3.14 python3.13 python3.12 python3.11
fi
check_environment
check_rust
check_linker
[ $missing -eq 0 ] || exit 1
printf '%s\n' "$python"
