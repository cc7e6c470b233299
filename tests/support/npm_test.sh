# shellcheck shell=bash disable=SC2154
# What tests with packages of npm share. It is sourced with `feeler`, the program, and `work`, a folder
# of the test.

# Ends the test as skipped.
skip() {
    printf 'skipped: %s\n' "$1"
    exit 77
}

need() {
    local command
    for command in "$@"; do
        command -v "$command" >/dev/null || skip "there is no $command"
    done
}

# Goes into the folder of the test, with the scripts and the packages that stand in the lock file beside
# the script that asks.
install_packages() {
    local here
    here=$(cd "$(dirname "${BASH_SOURCE[1]}")" && pwd -P)
    mkdir -p "$work"
    cp "$here"/package.json "$here"/package-lock.json "$here"/*.mjs "$work"
    cd "$work" || exit 1
    timeout 120 npm ci --ignore-scripts --no-audit --no-fund --prefer-offline --fetch-retries=0 \
        --fetch-timeout=20000 >npm.log 2>&1 || skip 'npm could not get its packages'
}

# A report of `feeler check`, which must end with this status, or with less than 2 for `any`.
make_report() {
    local wanted=$1 status=0
    shift
    "$feeler" check "$@" || status=$?
    [[ $wanted == "$status" || ($wanted == any && $status -lt 2) ]] || {
        printf 'feeler check ended with %s, not %s\n' "$status" "$wanted" >&2
        exit 1
    }
}
