# What the rigs share: where packages of others are installed, and how a rig is skipped.

# skip REASON: ends the rig as not run here.
skip() {
  mkdir -p .rigs
  echo "$1" >"${SKIP_REASON:-.rigs/skip-reason}"
  echo "skipped: $1" >&2
  exit 77
}

# Runs what installs something; its output only where it fails.
install_quietly() {
  local log=.rigs/install.log
  mkdir -p .rigs
  "$@" >"$log" 2>&1 || { tail -n 20 "$log" >&2; return 1; }
}

# Pinned packages of tests/rigs/requirements.txt, in .rigs/python.
python_packages() {
  cmp -s tests/rigs/requirements.txt .rigs/python/requirements.txt && return
  echo "installing the packages of tests/rigs/requirements.txt into .rigs/python"
  command -v python3 >/dev/null || skip "there is no python3 here"
  rm -rf .rigs/python
  install_quietly python3 -m venv .rigs/python || skip "python3 -m venv doesn't work here"
  install_quietly .rigs/python/bin/pip install --no-deps -r tests/rigs/requirements.txt \
    || skip "pip could not install tests/rigs/requirements.txt"
  cp tests/rigs/requirements.txt .rigs/python/
}

# Pinned packages of tests/rigs/package-lock.json, in .rigs/npm.
npm_packages() {
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
