# shellcheck shell=bash disable=SC2154
# What the tests of pages share: sourced with `work` set, it goes there with playwright-core at hand, or
# ends with 77 where Chromium, node or npm's packages are missing.
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)

skip() {
    printf 'skipped: %s\n' "$1"
    exit 77
}
for command in chromium node npm; do
    command -v "$command" >/dev/null || skip "there is no $command"
done
mkdir -p "$work"
cp "$here"/package.json "$here"/package-lock.json "$here"/*.mjs "$work"
cd "$work"
timeout 120 npm ci --ignore-scripts --no-audit --no-fund --prefer-offline --fetch-retries=0 \
    --fetch-timeout=20000 >npm.log 2>&1 || skip 'npm could not get playwright-core'

# A report of `feeler check`, whatever it finds; fails where it could not be made.
make_report() {
    local status=0
    "$feeler" check "$@" || status=$?
    ((status < 2)) || exit 1
}
