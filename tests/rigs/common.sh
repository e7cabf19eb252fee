# What the rigs share: where packages of others are installed, and how a rig is skipped.

# skip REASON: ends the rig as not run here.
skip() {
  mkdir -p .rigs
  echo "$1" >"${SKIP_REASON:-.rigs/skip-reason}"
  echo "skipped: $1" >&2
  exit 77
}

# Runs what installs or builds something; its output only where it fails.
install_quietly() {
  local log status=0
  log=$(mktemp)
  "$@" >"$log" 2>&1 || status=$?
  [ $status = 0 ] || tail -n 20 "$log" >&2
  rm -f "$log"
  return $status
}

# one_at_a_time FUNCTION ARGUMENT...: rigs run beside each other and want the same packages.
one_at_a_time() {
  mkdir -p .rigs
  # A daemon that is started all the same must not hold the lock.
  (flock 8; "$@" 8>&-) 8>.rigs/lock || exit $?
}

# installed: ends a rig that was only asked to install what it needs.
installed() { [ "${INSTALL_ONLY:-}" != true ] || exit 0; }

# Pinned packages of tests/rigs/requirements.txt, in .rigs/python; with a NAME those of
# requirements-NAME.txt, in .rigs/python-NAME.
python_packages() { one_at_a_time install_python_packages "$@"; }
install_python_packages() {
  local requirements=tests/rigs/requirements${1:+-$1}.txt folder=.rigs/python${1:+-$1}
  cmp -s "$requirements" "$folder/requirements.txt" && return
  echo "installing the packages of $requirements into $folder"
  command -v python3 >/dev/null || skip "there is no python3 here"
  rm -rf "$folder"
  install_quietly python3 -m venv "$folder" || skip "python3 -m venv doesn't work here"
  install_quietly "$folder/bin/pip" install --no-deps -r "$requirements" \
    || skip "pip could not install $requirements"
  cp "$requirements" "$folder/requirements.txt"
}

# A Debian package, unpacked into .rigs/debian and not installed.
debian_package() { one_at_a_time install_debian_package "$@"; }
install_debian_package() {
  local package=$1
  [ -e ".rigs/debian/$package" ] && return
  echo "unpacking the Debian package $package into .rigs/debian"
  mkdir -p .rigs/debian/download
  (cd .rigs/debian/download && rm -f "$package"_*.deb && apt-get download "$package" >download.log 2>&1) \
    || skip "the Debian package $package can't be fetched here"
  dpkg-deb -x .rigs/debian/download/"$package"_*.deb .rigs/debian \
    || skip "the Debian package $package can't be unpacked here"
  touch ".rigs/debian/$package"
}

# Pinned packages of tests/rigs/package-lock.json, in .rigs/npm.
npm_packages() { one_at_a_time install_npm_packages "$@"; }
install_npm_packages() {
  cmp -s tests/rigs/package-lock.json .rigs/npm/installed && return
  echo "installing the packages of tests/rigs/package-lock.json into .rigs/npm"
  command -v npm >/dev/null || skip "there is no npm here"
  rm -rf .rigs/npm
  mkdir -p .rigs/npm
  cp tests/rigs/package.json tests/rigs/package-lock.json .rigs/npm/
  PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD=1 install_quietly npm --prefix .rigs/npm ci --no-audit --no-fund \
    || skip "npm could not install tests/rigs/package-lock.json"
  cp .rigs/npm/package-lock.json .rigs/npm/installed
}

# apt_packages PROGRAM PACKAGE...: installs Debian packages where the program isn't there.
apt_packages() { one_at_a_time install_apt_packages "$@"; }
install_apt_packages() {
  local program=$1
  shift
  command -v "$program" >/dev/null && return
  echo "installing Debian's $*"
  [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null || skip "there is no $program, and no root with apt-get to install it"
  install_quietly apt-get update || skip "apt-get update failed: no $program"
  # In this run level no daemon is started: the rigs start those that they use.
  RUNLEVEL=1 DEBIAN_FRONTEND=noninteractive install_quietly apt-get install -y --no-install-recommends "$@" \
    || skip "apt-get could not install $*"
}

# named_tests ARGUMENT...: runs integration tests by name; fails where none has such a name.
named_tests() {
  local log
  log=$(mktemp)
  # Without a pipe, which a process that a test left behind would hold open.
  local status=0
  python3 tests/rigs/step.py --live "$log" cargo test --quiet "${test_profile[@]}" --test main -- "$@" || status=$?
  grep -qE '^test result: ok\. [1-9]' "$log" || { echo "no test is named so: $*" >&2; status=1; }
  rm -f "$log"
  return "$status"
}

# Cargo's options for everything that is built: another choice of profile, packages or features would build
# all of it again. Tests and program are of one build: the release profile, with all features, and what the tests add to them.
# The Python module has no test that cargo could run, and a rig of its own.
test_profile=(--release --workspace --exclude octant-python --features octant/full,octant-fmu-bind/testing,octant-state/outline)
export RUSTC_WORKSPACE_WRAPPER=$PWD/tests/rigs/rustc
build_reference() {
  rm -rf .rigs/reference
  CARGO_TARGET_DIR=.rigs/reference CARGO_INCREMENTAL=0 cargo build --release --package octant-calibration --quiet
}
build_program() { cargo build "${test_profile[@]}" --quiet; }
build_all() { build_program && cargo test "${test_profile[@]}" --quiet --no-run; }
