# What users do with what they install, and what has to come of it; $work, $short and $expected are of tests/rigs/dist.

# hashes_of FOLDER COMMAND...: runs a scenario into the folder; the stream hashes of its two methods.
hashes_of() {
  local folder=$1
  shift
  install_quietly "$@" >&2 || return
  python3 -c '
import json, sys
summary = json.load(open(sys.argv[1] + "/summary.json"))
print(summary["stream_hash"][:16], summary["baseline"]["stream_hash"][:16])' "$folder"
}

# same WHAT HASHES: they are those of the program that was built here.
same() {
  [ "$2" = "$expected" ] || { echo "FAIL $1: stream hashes $2, expected $expected" >&2; return 1; }
  echo "ok   $1: the same stream hashes"
}

# Highest version of glibc that files ask for.
glibc_of() {
  readelf -W --dyn-syms "$@" | grep -o 'GLIBC_[0-9][0-9.]*' | sed 's/GLIBC_//' | sort -Vu | tail -n 1
}
glibc_at_most() {
  local most=$1 found
  shift
  found=$(glibc_of "$@")
  [ "$(printf '%s\n%s\n' "$found" "$most" | sort -V | tail -n 1)" = "$most" ] \
    || { echo "FAIL needs glibc $found, expected at most $most" >&2; return 1; }
  echo "$found"
}

# in_its_own_process COMMAND...: the program finds itself, and starts itself again.
in_its_own_process() {
  "$@" | grep -q 'in its own process' || { echo "FAIL the program doesn't start itself: $*" >&2; return 1; }
  echo "ok   an FMU in a process of the program's own"
}

# debian_tree FOLDER ARCHITECTURE VARIANT: Debian 12 in a folder, made once. "extract" unpacks only, for another machine.
debian_tree() {
  local folder=$1 architecture=$2 variant=$3 include=()
  [ -e "$folder/etc/debian_version" ] && return
  echo "unpacking Debian 12 ($architecture) into $folder"
  [ "$(id -u)" = 0 ] || skip "a Debian in a folder needs root"
  [ "$variant" != extract ] || include=(--include=python3,libpython3-stdlib)
  rm -rf "$folder" "$folder.partial"
  mkdir -p "$(dirname "$folder")"
  install_quietly mmdebstrap --mode=root --variant="$variant" --arch="$architecture" "${include[@]}" bookworm "$folder.partial" \
    || skip "Debian 12 ($architecture) can't be fetched here"
  mv "$folder.partial" "$folder"
}

# in_chroot FOLDER COMMAND...: as a user without rights, who sees the processes of the folder alone.
in_chroot() {
  local folder=$1
  shift
  mkdir -p "$folder/proc"
  unshare --mount --pid --fork --mount-proc="$folder/proc" chroot --userspec=1000:1000 "$folder" \
    /usr/bin/env -i PATH=/usr/bin:/bin HOME=/tmp "$@"
}

# use_archive FILE NAME: unpacked in a bare folder.
use_archive() {
  local bare=$work/bare
  rm -rf "$bare"
  mkdir "$bare"
  tar -C "$bare" -xzf "$1"
  (
    cd "$bare"
    env -i PATH=/usr/bin:/bin HOME="$bare" "$2/bin/octant" --version
    env -i PATH=/usr/bin:/bin HOME="$bare" "$2/bin/octant" fmu build --out fmus >fmus.log
    for page in "$2"/share/man/man1/octant.1 "$2"/share/doc/octant/THIRD-PARTY.txt; do [ -s "$page" ]; done
    bash -n "$2/share/bash-completion/completions/octant"
  )
  same "archive" "$(hashes_of "$bare/run" env -i PATH=/usr/bin:/bin HOME="$bare" "$bare/$2/bin/octant" \
    run "$bare/$2/share/octant/scenarios/quick.toml" "${short[@]}" --out "$bare/run")"
}

# use_deb FILE: installed, used and removed in a Debian 12.
use_deb() {
  local tree=$work/debian before
  rm -rf "$tree"
  cp -a .rigs/dist/debian "$tree"
  cp "$1" "$tree/tmp/octant.deb"
  before=$(find "$tree/usr" | sort | sha256sum)
  install_quietly chroot "$tree" dpkg -i /tmp/octant.deb
  chroot "$tree" dpkg --verify octant
  in_chroot "$tree" octant --version
  in_chroot "$tree" octant fmu build --out /tmp/fmus >/dev/null
  same ".deb in a Debian 12" "$(hashes_of "$tree/tmp/run" in_chroot "$tree" octant run /usr/share/octant/scenarios/quick.toml \
    "${short[@]}" --out /tmp/run)"
  in_its_own_process in_chroot "$tree" octant fmu run /tmp/fmus/plant_fmi3.fmu --stop 1
  install_quietly chroot "$tree" dpkg -r octant
  [ "$before" = "$(find "$tree/usr" | sort | sha256sum)" ] || { echo "FAIL files are left after dpkg -r octant" >&2; return 1; }
  echo "ok   .deb removed without a rest"
  rm -rf "$tree"
}

# use_image FILE: unpacked as an engine would, and started with the entry point and the user of its configuration.
use_image() {
  local folder=$work/image root entry
  rm -rf "$folder"
  mkdir -p "$folder/layout"
  tar -C "$folder/layout" -xf "$1"
  install_quietly umoci unpack --image "$folder/layout:$version" "$folder/bundle"
  root=$folder/bundle/rootfs
  entry=$(python3 -c '
import json, sys
process = json.load(open(sys.argv[1]))["process"]
assert process["user"]["uid"] == 1000 and process["cwd"] == "/work", process
print(*process["args"])' "$folder/bundle/config.json")
  # No shell and no env are in it: chroot starts the program itself.
  started() {
    # An engine gives /proc and /dev.
    unshare --mount --pid --fork --mount-proc="$root/proc" sh -c 'mount --rbind /dev "$0/dev" && exec chroot --userspec=1000:1000 "$0" "$@"' \
      "$root" "$entry" "$@"
  }
  started --version
  same "image" "$(hashes_of "$root/work/run" started run /usr/share/octant/scenarios/quick.toml "${short[@]}" --out /work/run)"
  # Without certificates it would not get as far as the connection that is refused.
  if AWS_ENDPOINT_URL=https://127.0.0.1:9 AWS_ACCESS_KEY_ID=none AWS_SECRET_ACCESS_KEY=none OCTANT_STORAGE_RETRY_S=0 \
    started campaign status s3://bucket/none 2>"$work/refused" || ! grep -q 'failed to read s3://bucket/none' "$work/refused"; then
    cat "$work/refused" >&2
    echo "FAIL the image has no certificates" >&2
    return 1
  fi
  started fmu build --out /work/fmus >/dev/null
  in_its_own_process started fmu run /work/fmus/plant_fmi3.fmu --stop 1
}

# use_under_qemu PROGRAM: a program for 64-bit ARM, with the C library of Debian 12.
use_under_qemu() {
  local folder
  folder=$(mktemp -d "$work/qemu.XXXX")
  same "aarch64 under qemu-user" "$(hashes_of "$folder/run" qemu-aarch64-static -L .rigs/dist/arm64 "$1" \
    run fixtures/scenarios/quick.toml "${short[@]}" --out "$folder/run")"
}

# use_fmus FOLDER: the libraries of three platforms, loaded from the same files and stepped in closed loop.
use_fmus() {
  local fmus=$1 zig=("$python" -m ziglang cc -O1 -Wall -I "$work/fmu") source=tests/rigs/fmu/platforms.c
  local file linux arm windows
  for file in "$fmus"/*.fmu; do
    "$own" fmu check --step "$file" >"$work/check.log" || true
    grep -q '  0 errors, ' "$work/check.log" || { cat "$work/check.log" >&2; return 1; }
  done
  echo "ok   octant fmu check finds no error"
  mkdir -p "$work/fmu"
  python3 tests/rigs/fmu/platforms.py "$fmus/plant_fmi3.fmu" "$fmus/calibrator_fmi3.fmu" >"$work/fmu/wiring.h"
  for file in plant_fmi3 calibrator_fmi3; do python3 -m zipfile -e "$fmus/$file.fmu" "$work/fmu/$file"; done
  "${zig[@]}" -target x86_64-linux-gnu.2.17 -o "$work/fmu/x86_64" "$source" -ldl
  "${zig[@]}" -target aarch64-linux-gnu.2.17 -o "$work/fmu/aarch64" "$source" -ldl
  "${zig[@]}" -target x86_64-windows-gnu -o "$work/fmu/windows.exe" "$source"
  # Beside the program, where Windows looks first; Wine 9 and later have their own.
  "${zig[@]}" -target x86_64-windows-gnu -shared -o "$work/fmu/bcryptprimitives.dll" tests/rigs/fmu/bcryptprimitives.c -ladvapi32
  loop() {
    local platform=$1 extension=$2
    shift 2
    (cd "$work/fmu" && "$@" "plant_fmi3/binaries/$platform/plant_fmi3.$extension" \
      "calibrator_fmi3/binaries/$platform/calibrator_fmi3.$extension" 120000)
  }
  linux=$(loop x86_64-linux so ./x86_64)
  echo "     $linux"
  arm=$(loop aarch64-linux so qemu-aarch64-static -L "$PWD/.rigs/dist/arm64" ./aarch64)
  [ "$arm" = "$linux" ] || { echo "FAIL aarch64: $arm" >&2; return 1; }
  echo "ok   the library for 64-bit ARM under qemu-user: the same outputs"
  windows=$(WINEPREFIX=$PWD/.rigs/dist/wine WINEDEBUG=-all loop x86_64-windows dll "$(wine_program)" windows.exe | tr -d '\r')
  [ "$windows" = "$linux" ] || { echo "FAIL Windows: $windows" >&2; return 1; }
  echo "ok   the library for Windows under Wine: the same outputs"
}
wine_program() { [ -x /usr/lib/wine/wine64 ] && echo /usr/lib/wine/wine64 || command -v wine; }

# wheel_fits FILE: its size, and the tag that auditwheel finds for it.
wheel_fits() {
  local size
  size=$(stat -c %s "$1")
  [ "$size" -le 15000000 ] || { echo "FAIL the wheel has $size bytes, at most 15000000 are asked for" >&2; return 1; }
  "$python" -m auditwheel show "$1" >"$work/audit.log" 2>&1
  tr '\n' ' ' <"$work/audit.log" | grep -qE '"?manylinux_2_(5|12|17)_' || { cat "$work/audit.log" >&2; return 1; }
  echo "auditwheel: $(grep -oE 'manylinux_2_[0-9]+_[a-z0-9_]+' "$work/audit.log" | head -n 1)" >"$work/remark"
}

USE_OF_PYTHON='
import octant, sys
run = octant.run(sys.argv[1], out=sys.argv[2], set={"procedure.calibration.duration": "1 h", "procedure.navigation.duration": "1 h"}, progress=False)
'

# use_wheel FILE: in an environment of its own, with NumPy alone.
use_wheel() {
  local folder=$work/wheel
  rm -rf "$folder"
  python3 -m venv "$folder"
  install_quietly "$folder/bin/pip" install "$1"
  "$folder/bin/octant" --version
  cp fixtures/scenarios/quick.toml "$folder/"
  same "octant of the wheel" "$(hashes_of "$folder/run" env -C "$folder" bin/octant run quick.toml "${short[@]}" --out "$folder/run")"
  same "octant.run of the wheel" "$(hashes_of "$folder/python" "$folder/bin/python" -c "$USE_OF_PYTHON" "$folder/quick.toml" "$folder/python")"
  in_its_own_process "$folder/bin/octant" fmu run "$folder"/lib/python3*/site-packages/octant/fmus/plant_fmi3.fmu --stop 1
}

# use_arm_wheel FILE: unpacked beside a Python for 64-bit ARM, under qemu-user.
use_arm_wheel() {
  local folder=$work/arm-wheel tree=$PWD/.rigs/dist/arm64
  rm -rf "$folder"
  install_quietly "$python" -m pip install --target "$folder" --platform manylinux2014_aarch64 --python-version 3.11 \
    --only-binary=:all: "$1"
  same "octant.run of the wheel for 64-bit ARM" "$(hashes_of "$folder/run" env PYTHONPATH="$folder" qemu-aarch64-static -L "$tree" \
    "$tree/usr/bin/python3.11" -c "$USE_OF_PYTHON" fixtures/scenarios/quick.toml "$folder/run")"
  use_under_qemu "$folder/bin/octant"
}
