# shellcheck shell=bash disable=SC2154
# Common functions of tests with npm packages. Source it with `feeler`, the program, and `work`, a
# folder of the test, set.

# Ends the test as skipped, or as failed with FEELER_REQUIRE_SHARED, as in CI.
skip() {
    printf 'skipped: %s\n' "$1"
    [[ -z ${FEELER_REQUIRE_SHARED:-} ]] || exit 1
    exit 77
}

need() {
    local command
    for command in "$@"; do
        command -v "$command" >/dev/null || skip "there is no $command"
    done
}

# install_packages FOLDER...: changes to the folder of the test, with the scripts (.mjs) of these
# folders and the packages of their lock file.
install_packages() {
    local folder
    mkdir -p "$work"
    for folder in "$@"; do cp "$folder"/*.mjs "$work"; done
    for folder in "$@"; do
        [[ ! -e $folder/package.json ]] || cp "$folder"/package.json "$folder"/package-lock.json "$work"
    done
    cd "$work" || exit 1
    # One npm at a time fills the cache. A registry now and then does not answer.
    exec {npm_lock}>"${TMPDIR:-/tmp}/feeler-npm-$UID.lock"
    flock "$npm_lock"
    get_packages || get_packages || {
        tail npm.log
        skip 'npm could not get its packages'
    }
    exec {npm_lock}>&-
}

get_packages() {
    # clock: gives up after 5 min
    timeout 300 npm ci --ignore-scripts --no-audit --no-fund --prefer-offline --fetch-retries=4 \
        >npm.log 2>&1
}

# A report of `feeler check`, which must end with this status, or with a status below 2 for `any`.
make_report() {
    local wanted=$1 status=0
    shift
    "$feeler" check "$@" || status=$?
    [[ $wanted == "$status" || ($wanted == any && $status -lt 2) ]] || {
        printf 'feeler check ended with %s, not %s\n' "$status" "$wanted" >&2
        exit 1
    }
}
